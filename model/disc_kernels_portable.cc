// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#define TORSO_KERNELS kDiscKernelsPortable
#define TORSO_KERNELS_NAME "portable"
#include "model/disc_kernels.inc"
