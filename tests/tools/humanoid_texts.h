// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#pragma once

// Little humanoids of our own in the forms that people write: for tests of the graft.

#include <string>

namespace torso::tools {

// Both sides of a limb. `name` with LEFT or RIGHT put in front; $Y is the sign of the side.
inline std::string bothSides(const std::string& text, const std::string& left,
                             const std::string& right) {
  const auto replaced = [](std::string s, const std::string& what, const std::string& by) {
    for (std::size_t i = 0; (i = s.find(what, i)) != std::string::npos; i += by.size()) {
      s.replace(i, what.size(), by);
    }
    return s;
  };
  return replaced(replaced(text, "$S", left), "$Y", "") +
         replaced(replaced(text, "$S", right), "$Y", "-");
}

// The root is the chest, hinges lead down to the pelvis; degrees; motors. With an element of each
// kind that may refer to the trunk.
inline std::string waistDownHumanoid() {
  return R"(<mujoco model="waist_down">
  <compiler angle="degree"/>
  <option timestep="0.004" integrator="RK4"/>
  <default>
    <joint damping="0.4" armature="0.01" limited="true"/>
    <geom friction="0.9 0.1 0.1" material="skin"/>
    <motor ctrllimited="true" ctrlrange="-1 1"/>
    <default class="foot"><geom friction="1.2 0.1 0.1"/></default>
  </default>
  <asset><material name="skin" rgba="0.8 0.6 0.4 1"/></asset>
  <worldbody>
    <light name="sun" pos="0 0 4"/>
    <geom name="floor" type="plane" size="5 5 0.1"/>
    <body name="torso" pos="0 0 1.3">
      <freejoint name="root"/>
      <camera name="track" mode="trackcom" pos="0 -3 0" xyaxes="1 0 0 0 0 1"/>
      <site name="imu" pos="0.05 0 0.02" size="0.01"/>
      <geom name="chest" type="capsule" fromto="0 -0.07 0 0 0.07 0" size="0.08"/>
      <geom type="capsule" fromto="0 -0.05 -0.1 0 0.05 -0.1" size="0.06"/>
      <body name="head" pos="0 0 0.2"><geom name="head" size="0.09"/></body>
      <body name="waist" pos="0 0 -0.2">
        <joint name="abdomen_z" axis="0 0 1" range="-45 45" pos="0 0 0.05"/>
        <joint name="abdomen_y" axis="0 1 0" range="-75 30" pos="0 0 0.05"/>
        <geom name="waist" type="capsule" fromto="0 -0.05 0 0 0.05 0" size="0.06"/>
        <body name="pelvis" pos="0 0 -0.16">
          <joint name="abdomen_x" axis="1 0 0" range="-35 35" pos="0 0 0.1"/>
          <geom name="butt" type="capsule" fromto="0 -0.06 0 0 0.06 0" size="0.09"/>)" +
         bothSides(R"(
          <body name="$S_thigh" pos="0 $Y0.1 -0.04">
            <joint name="$S_hip_x" axis="1 0 0" range="-30 30"/>
            <joint name="$S_hip_z" axis="0 0 1" range="-60 35"/>
            <joint name="$S_hip_y" axis="0 1 0" range="-110 20"/>
            <geom name="$S_thigh" type="capsule" fromto="0 0 0 0 0 -0.34" size="0.06"/>
            <body name="$S_shin" pos="0 0 -0.4">
              <joint name="$S_knee" axis="0 -1 0" range="-160 2" pos="0 0 0.02"/>
              <geom name="$S_shin" type="capsule" fromto="0 0 0 0 0 -0.3" size="0.05"/>
              <body name="$S_foot" pos="0 0 -0.4">
                <joint name="$S_ankle" axis="0 1 0" range="-50 50"/>
                <geom class="foot" type="capsule" fromto="-0.05 0 0 0.12 0 0" size="0.03"/>
                <site name="$S_sole" pos="0 0 -0.03" size="0.01"/>
              </body>
            </body>
          </body>)",
                   "left", "right") +
         R"(
        </body>
      </body>)" +
         bothSides(R"(
      <body name="$S_upper_arm" pos="0 $Y0.17 0.06">
        <joint name="$S_shoulder1" axis="2 1 1" range="-85 60"/>
        <joint name="$S_shoulder2" axis="0 -1 1" range="-85 60"/>
        <geom name="$S_upper_arm" type="capsule" fromto="0 0 0 0.16 $Y0.1 -0.16" size="0.04"/>
        <body name="$S_lower_arm" pos="0.18 $Y0.11 -0.18">
          <joint name="$S_elbow" axis="0 -1 1" range="-90 50"/>
          <geom name="$S_lower_arm" type="capsule" fromto="0 0 0 0.17 0 0.1" size="0.03"/>
        </body>
      </body>)",
                   "left", "right") +
         R"(
    </body>
    <body name="ball" pos="1 1 0.2"><freejoint/><geom name="ball" size="0.1"/></body>
  </worldbody>
  <contact>
    <exclude body1="waist" body2="left_thigh"/>
    <exclude name="shins" body1="left_shin" body2="right_shin"/>
    <pair geom1="left_shin" geom2="butt"/>
  </contact>
  <tendon>
    <fixed name="left_hipknee">
      <joint joint="left_hip_y" coef="-1"/><joint joint="left_knee" coef="1"/>
    </fixed>
    <spatial name="strap"><site site="imu"/><site site="left_sole"/></spatial>
  </tendon>
  <actuator>
    <motor name="abdomen_y" joint="abdomen_y" gear="60"/>
    <motor name="abdomen_z" joint="abdomen_z" gear="40"/>
    <motor name="abdomen_x" joint="abdomen_x" gear="40"/>
    <motor name="left_hip_y" joint="left_hip_y" gear="80"/>
    <motor name="right_hip_y" joint="right_hip_y" gear="80"/>
    <motor name="left_knee" joint="left_knee" gear="60"/>
    <position name="right_knee" joint="right_knee" kp="50" ctrlrange="-100 0" ctrllimited="true"/>
    <motor name="left_shoulder1" joint="left_shoulder1" gear="20"/>
  </actuator>
  <sensor>
    <accelerometer name="imu" site="imu"/>
    <jointpos name="abdomen_y" joint="abdomen_y"/>
    <jointpos name="knee" joint="left_knee"/>
    <subtreelinvel name="velocity" body="torso"/>
    <actuatorfrc name="bend" actuator="abdomen_y"/>
  </sensor>
  <custom><text name="note" data="kept"/></custom>
  <keyframe><key name="start" time="1" qpos="0 0 1.3 1 0 0 0 )" +
         std::string("0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 1 1 0.2 1 0 0 0") + R"("/></keyframe>
</mujoco>
)";
}

// The root is the pelvis, on slides and hinges; a chain of spine bodies, neck and clavicles;
// radians; position servos; childclass; sides L_ and R_.
inline std::string pelvisUpHumanoid() {
  return R"(<mujoco model="pelvis_up">
  <compiler angle="radian" autolimits="true" boundmass="0.3" boundinertia="0.002"/>
  <option timestep="0.001" solver="PGS"/>
  <default>
    <default class="walker">
      <joint damping="0.5" armature="0.005"/>
      <geom contype="4" conaffinity="4" condim="3"/>
      <default class="servo"><position kp="40" ctrlrange="-0.5 0.5"/></default>
    </default>
  </default>
  <worldbody>
    <geom name="ground" type="plane" size="0 0 1" contype="4" conaffinity="4"/>
    <body name="Hips" pos="0 0 1" childclass="walker">
      <joint name="x" type="slide" axis="1 0 0"/><joint name="y" type="slide" axis="0 1 0"/>
      <joint name="z" type="slide" axis="0 0 1"/><joint name="tilt" type="ball"/>
      <geom type="box" size="0.07 0.12 0.06"/>)" +
         bothSides(R"(
      <body name="$S_Thigh" pos="0 $Y0.09 -0.05" euler="0 0.05 0">
        <joint name="$S_Hip" type="ball"/>
        <geom type="capsule" fromto="0 0 0 0 0 -0.38" size="0.06"/>
        <body name="$S_Calf" pos="0 0 -0.42">
          <joint name="$S_Knee" axis="0 1 0" range="0 2.5"/>
          <geom type="capsule" fromto="0 0 0 0 0 -0.36" size="0.045"/>
          <body name="$S_Foot" pos="0 0 -0.4">
            <joint name="$S_Ankle_y" axis="0 1 0" range="-0.7 0.7"/>
            <joint name="$S_Ankle_x" axis="1 0 0" range="-0.4 0.4"/>
            <geom type="box" size="0.1 0.04 0.02" pos="0.06 0 -0.02"/>
          </body>
        </body>
      </body>)",
                   "L", "R") +
         R"(
      <body name="Spine1" pos="0 0 0.1">
        <joint name="Spine1_y" axis="0 1 0" range="-0.5 0.8"/>
        <joint name="Spine1_x" axis="1 0 0" range="-0.4 0.4"/>
        <geom type="capsule" fromto="0 -0.05 0 0 0.05 0" size="0.07"/>
        <body name="Spine2" pos="0 0 0.12">
          <joint name="Spine2_y" axis="0 1 0" range="-0.5 0.8"/>
          <geom type="capsule" fromto="0 -0.05 0 0 0.05 0" size="0.07"/>
          <body name="Chest" pos="0 0 0.13">
            <joint name="Chest_z" axis="0 0 1" range="-0.6 0.6"/>
            <geom type="box" size="0.08 0.13 0.1" pos="0 0 0.06"/>
            <site name="sternum" pos="0.09 0 0.05"/>
            <body name="Neck" pos="0 0 0.2">
              <joint name="Neck_y" axis="0 1 0" range="-0.5 0.5"/>
              <geom type="capsule" fromto="0 0 0 0 0 0.08" size="0.04"/>
              <body name="Head" pos="0 0 0.12">
                <joint name="Head_y" axis="0 1 0" range="-0.5 0.5"/>
                <geom size="0.09" pos="0 0 0.08"/>
                <camera name="eyes" pos="0.1 0 0.1" xyaxes="0 -1 0 0 0 1"/>
              </body>
            </body>)" +
         bothSides(R"(
            <body name="$S_Clavicle" pos="0 $Y0.03 0.14">
              <joint name="$S_Clavicle_x" axis="1 0 0" range="-0.3 0.3"/>
              <geom type="capsule" fromto="0 0 0 0 $Y0.12 0" size="0.02"/>
              <body name="$S_Arm" pos="0 $Y0.15 0">
                <joint name="$S_Shoulder" type="ball"/>
                <geom type="capsule" fromto="0 0 0 0 $Y0.25 0" size="0.04"/>
                <body name="$S_Forearm" pos="0 $Y0.28 0">
                  <joint name="$S_Elbow" axis="0 0 1" range="-2.4 2.4"/>
                  <geom type="capsule" fromto="0 0 0 0 $Y0.22 0" size="0.03"/>
                </body>
              </body>
            </body>)",
                   "L", "R") +
         R"(
          </body>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator>
    <position name="Spine1_y" class="servo" joint="Spine1_y"/>
    <position name="Spine1_x" class="servo" joint="Spine1_x"/>
    <position name="Spine2_y" class="servo" joint="Spine2_y"/>
    <position name="Chest_z" class="servo" joint="Chest_z"/>
    <position name="Neck_y" class="servo" joint="Neck_y"/>
    <position name="Head_y" class="servo" joint="Head_y"/>
    <position name="L_Clavicle_x" class="servo" joint="L_Clavicle_x"/>
    <velocity name="brake" joint="Spine2_y" kv="2"/>
    <position name="L_Knee" class="servo" joint="L_Knee"/>
    <position name="R_Knee" class="servo" joint="R_Knee"/>
  </actuator>
  <sensor><framequat name="chest" objtype="xbody" objname="Chest"/><velocimeter site="sternum"/></sensor>
</mujoco>
)";
}

// One rigid trunk that is fixed to the world, no name says what anything is: legs by their mass,
// left and right by the feet. No actuators.
inline std::string plainHumanoid() {
  return R"(<mujoco model="plain">
  <worldbody>
    <body name="base" pos="0 0 1.1">
      <geom type="box" size="0.1 0.15 0.28" mass="30"/>)" +
         bothSides(R"(
      <body name="a$S" pos="0 $Y0.1 -0.3">
        <joint axis="1 0 0"/><joint axis="0 1 0"/><joint axis="0 0 1"/>
        <geom type="capsule" fromto="0 0 0 0 0 -0.4" size="0.06"/>
        <body name="b$S" pos="0 0 -0.42">
          <joint axis="0 1 0"/>
          <geom type="capsule" fromto="0 0 0 0 0 -0.35" size="0.05"/>
          <body name="c$S" pos="0 0 -0.4">
            <joint axis="0 1 0"/>
            <geom type="box" size="0.1 0.04 0.02" pos="0.07 0 0"/>
          </body>
        </body>
      </body>
      <body name="d$S" pos="0 $Y0.2 0.22">
        <joint axis="1 0 0"/><joint axis="0 1 0"/>
        <geom type="capsule" fromto="0 0 0 0 0 -0.25" size="0.04"/>
        <body name="e$S" pos="0 0 -0.28">
          <joint axis="0 1 0"/>
          <geom type="capsule" fromto="0 0 0 0 0 -0.22" size="0.035"/>
        </body>
      </body>)",
                   "1", "2") +
         R"(
    </body>
  </worldbody>
</mujoco>
)";
}

}  // namespace torso::tools
