// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/mjcf.h"
#include "tools/torso_mjcf.h"

namespace torso::tools {

void writeScene(tinyxml2::XMLDocument& document) {
  document.InsertEndChild(
      document.NewComment(" Floor, light and sky for human.xml, or for a scene of your own. "
                          "Written by `torso build`. "));
  tinyxml2::XMLElement* root = document.NewElement("mujoco");
  document.InsertEndChild(root);

  Element visual(root, "visual");
  Element(visual, "headlight")
      .set("ambient", {0.3, 0.3, 0.3})
      .set("diffuse", {0.56, 0.56, 0.56})
      .set("specular", {0.1, 0.1, 0.1});
  Element(visual, "map").set("znear", 0.01).set("zfar", 40).set("force", 0.02);
  // Slices and stacks: of the 440 ligaments, whose capsules would otherwise have ten times as many
  // triangles as the bones.
  Element(visual, "quality")
      .set("shadowsize", 4096)
      .set("offsamples", 8)
      .set("numslices", 16)
      .set("numstacks", 8);
  Element(visual, "global")
      .set("azimuth", 140)
      .set("elevation", -14)
      .set("offwidth", 1920)
      .set("offheight", 1440);
  Element(visual, "scale")
      .set("forcewidth", 0.03)
      .set("contactwidth", 0.06)
      .set("contactheight", 0.02);
  Element(visual, "rgba").set("haze", {0.90, 0.92, 0.94, 1});
  Element(root, "statistic").set("center", {0, 0, 0.75}).set("extent", 1.7);

  Element asset(root, "asset");
  Element(asset, "texture")
      .set("type", "skybox")
      .set("builtin", "gradient")
      .set("rgb1", {0.93, 0.94, 0.95})
      .set("rgb2", {0.62, 0.68, 0.74})
      .set("width", 256)
      .set("height", 1536);
  Element(asset, "texture")
      .set("name", "floor")
      .set("type", "2d")
      .set("builtin", "checker")
      .set("rgb1", {0.78, 0.80, 0.82})
      .set("rgb2", {0.70, 0.73, 0.76})
      .set("width", 512)
      .set("height", 512);
  Element(asset, "material")
      .set("name", "floor")
      .set("texture", "floor")
      .set("texrepeat", {2, 2})
      .set("texuniform", "true");

  Element world(root, "worldbody");
  Element(world, "geom")
      .set("name", "floor")
      .set("type", "plane")
      .set("size", {0, 0, 0.05})
      .set("material", "floor")
      .set("condim", 3);
  // Shadow maps draw patches and stripes on smooth shaded bones. So the light that models the bones
  // casts none, and a weak one from above those that put them on the floor.
  Element(world, "light")
      .set("name", "key")
      .set("directional", "true")
      .set("castshadow", "false")
      .set("pos", {2, 1.5, 4})
      .set("dir", {-0.6, -0.5, -0.8})
      .set("diffuse", {0.38, 0.38, 0.36})
      .set("specular", {0.15, 0.15, 0.15});
  Element(world, "light")
      .set("name", "sky")
      .set("directional", "true")
      .set("pos", {0.5, 0.3, 4})
      .set("dir", {-0.1, -0.08, -1})
      .set("diffuse", {0.16, 0.16, 0.17})
      .set("specular", {0, 0, 0});
}

void writeHeldScene(tinyxml2::XMLDocument& document) {
  document.InsertEndChild(
      document.NewComment(" The torso with its pelvis held in the air, to try the servos on. "
                          "Written by `torso build`. "));
  tinyxml2::XMLElement* root = document.NewElement("mujoco");
  document.InsertEndChild(root);
  Element(root, "include").set("file", "scene.xml");
  Element(root, "include").set("file", "torso.xml");
  Element equality(root, "equality");
  Element(equality, "weld").set("name", "held").set("body1", "pelvis").set("solref", {0.004, 1});
}

}  // namespace torso::tools
