// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#define TORSO_KERNELS kDiscKernelsAvx2
#define TORSO_KERNELS_NAME "avx2"
#include "model/disc_kernels.inc"
