#!/usr/bin/env python3
# Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
"""Rollouts from Python without bindings: ctypes and the C header, plugin/mujoco_torso.h.

    python3 examples/rollout.py build/plugin/libmujoco_torso.so mjcf/torso_held.xml

Rolls a model out from rest with several constant controls, and prints how fast it moved; rollout.c
is the same in C. It needs Python 3 alone. numpy.ctypeslib.as_array(array) views the arrays here as
NumPy's, without a copy.
"""
import argparse
import ctypes
import sys
from ctypes import CFUNCTYPE, POINTER, byref, c_char_p, c_double, c_int, c_void_p

# torsoState
PHYSICS, USERDATA, WARMSTART, FULL = 1, 2, 4, 7

# torsofInput and torsofCost. Threads wait for each other in Python functions: for speed leave them
# out, set all controls before and compute costs from the states, as here.
Input = CFUNCTYPE(None, c_void_p, c_void_p, c_int, c_int, c_void_p)
Cost = CFUNCTYPE(c_double, c_void_p, c_void_p, c_int, c_int, c_void_p)


class Rollout(ctypes.Structure):
    """torsoRollout, member by member."""
    _fields_ = [
        ("ntrajectory", c_int), ("nstep", c_int),
        ("initial_state", POINTER(c_double)), ("ninitial", c_int), ("initial_spec", c_int),
        ("control", POINTER(c_double)), ("input", Input),
        ("state", POINTER(c_double)), ("state_spec", c_int),
        ("sensordata", POINTER(c_double)), ("final_state", POINTER(c_double)),
        ("step_cost", Cost), ("cost", POINTER(c_double)),
        ("status", POINTER(c_int)), ("steps", POINTER(c_int)),
        ("user", c_void_p), ("cancel", POINTER(c_int)),
    ]


class ModelSizes(ctypes.Structure):
    """The first members of mjModel (mujoco/mjmodel.h)."""
    _fields_ = [("nq", c_int), ("nv", c_int), ("nu", c_int), ("na", c_int)]


def load_libraries(plugin):
    mujoco, torso = ctypes.CDLL("libmujoco.so.2.2.2"), ctypes.CDLL(plugin)
    mujoco.mj_loadXML.restype = c_void_p
    mujoco.mj_loadXML.argtypes = [c_char_p, c_void_p, c_char_p, c_int]
    mujoco.mj_makeData.restype = c_void_p
    mujoco.mj_makeData.argtypes = [c_void_p]
    mujoco.mj_deleteData.argtypes = [c_void_p]
    mujoco.mj_deleteModel.argtypes = [c_void_p]
    torso.torso_stateSize.argtypes = [c_void_p, c_int]
    torso.torso_defaultRollout.argtypes = [POINTER(Rollout)]
    torso.torso_rollout.argtypes = [c_void_p, POINTER(c_void_p), c_int, POINTER(Rollout)]
    torso.torso_statusText.restype = c_char_p
    torso.torso_lastError.argtypes = [c_char_p, c_int]
    return mujoco, torso


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("plugin", help="libmujoco_torso.so")
    parser.add_argument("model", help="MJCF or URDF file")
    parser.add_argument("--trajectories", type=int, default=8)
    parser.add_argument("--steps", type=int, default=60)
    parser.add_argument("--threads", type=int, default=2)
    args = parser.parse_args()

    mujoco, torso = load_libraries(args.plugin)
    error = ctypes.create_string_buffer(1000)
    m = mujoco.mj_loadXML(args.model.encode(), None, error, len(error))
    if not m:
        sys.exit(error.value.decode())
    data = (c_void_p * args.threads)(*(mujoco.mj_makeData(m) for _ in range(args.threads)))

    # Arrays in C's order: trajectory, step, entry.
    n, steps = args.trajectories, args.steps
    size = ModelSizes.from_address(m)
    nstate = torso.torso_stateSize(m, PHYSICS)  # time, qpos, qvel, act
    control = (c_double * (n * steps * size.nu))()
    for i in range(n):
        begin, count = i * steps * size.nu, steps * size.nu
        control[begin:begin + count] = [0.02 * i] * count
    state = (c_double * (n * steps * nstate))()
    status = (c_int * n)()

    r = Rollout()
    torso.torso_defaultRollout(byref(r))
    r.ntrajectory, r.nstep = n, steps
    r.control, r.state, r.status = control, state, status
    failed = torso.torso_rollout(m, data, args.threads, byref(r))
    if failed < 0:
        torso.torso_lastError(error, len(error))
        sys.exit(error.value.decode())

    for i in range(n):
        mean = 0
        for k in range(steps):
            qvel = (i * steps + k) * nstate + 1 + size.nq
            mean += sum(v * v for v in state[qvel:qvel + size.nv]) / (size.nv * steps)
        text = torso.torso_statusText(status[i]).decode()
        print(f"control {0.02 * i:.2f}: mean squared speed {mean:.6g}, {text}")

    for d in data:
        mujoco.mj_deleteData(d)
    mujoco.mj_deleteModel(m)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
