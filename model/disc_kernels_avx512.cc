// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#define TORSO_KERNELS kDiscKernelsAvx512
#define TORSO_KERNELS_NAME "avx512"
#include "model/disc_kernels.inc"
