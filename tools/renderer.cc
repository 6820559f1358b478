// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "tools/renderer.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/gl.h>
#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "tools/error.h"
#include "tools/extent.h"

namespace torso::tools {

// An OpenGL context that is current on this thread while the object lives.
struct Renderer::Context {
  Context() {
    // Mesa draws without any window system; other drivers offer their default display.
    display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (!display || !eglInitialize(display, nullptr, nullptr)) {
      display = eglGetDisplay(EGL_DEFAULT_DISPLAY);
      if (!display || !eglInitialize(display, nullptr, nullptr)) {
        throw Error("no EGL display for offscreen pictures; install libegl-mesa0");
      }
    }
    const std::array<EGLint, 15> attributes = {EGL_SURFACE_TYPE,
                                               EGL_PBUFFER_BIT,
                                               EGL_RED_SIZE,
                                               8,
                                               EGL_GREEN_SIZE,
                                               8,
                                               EGL_BLUE_SIZE,
                                               8,
                                               EGL_DEPTH_SIZE,
                                               24,
                                               EGL_STENCIL_SIZE,
                                               8,
                                               EGL_RENDERABLE_TYPE,
                                               EGL_OPENGL_BIT,
                                               EGL_NONE};
    EGLConfig config = nullptr;
    EGLint found = 0;
    if (eglChooseConfig(display, attributes.data(), &config, 1, &found) && found > 0 &&
        eglBindAPI(EGL_OPENGL_API)) {
      context = eglCreateContext(display, config, EGL_NO_CONTEXT, nullptr);
    }
    if (!context || !eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) {
      eglTerminate(display);
      throw Error("EGL has no OpenGL context without a surface; install libgl1-mesa-dri");
    }
  }

  ~Context() {
    eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display, context);
    eglTerminate(display);
  }

  EGLDisplay display = nullptr;
  EGLContext context = nullptr;
};

namespace {

constexpr int kMostSticks = 2000;  // drawn in a picture

void addSticks(const std::vector<Stick>& sticks, mjvScene* scene) {
  constexpr double kRadius = 0.014;  // [m]
  constexpr float kColour[4] = {0.85f, 0.33f, 0.16f, 1};
  const auto count = std::min<std::size_t>(sticks.size(), kMostSticks);
  for (std::size_t i = 0; i < count && scene->ngeom < scene->maxgeom; i++) {
    const Eigen::Vector3d &a = sticks[i].from, &b = sticks[i].to;
    mjvGeom* geom = scene->geoms + scene->ngeom++;
    mjv_initGeom(geom, mjGEOM_CAPSULE, nullptr, nullptr, nullptr, kColour);
    mjv_makeConnector(geom, mjGEOM_CAPSULE, kRadius, a.x(), a.y(), a.z(), b.x(), b.y(), b.z());
    geom->category = mjCAT_DECOR;
  }
}

}  // namespace

// What MuJoCo's visualiser and renderer make of one model.
struct Renderer::Stage {
  Stage(const mjModel* m, int width, int height) {
    mjv_defaultScene(&scene);
    mjr_defaultContext(&gl);
    try {
      mjr_makeContext(m, &gl, height < 1400 ? mjFONTSCALE_100 : mjFONTSCALE_200);
      if (height < 720) mjr_changeFont(mjFONTSCALE_50, &gl);  // mjr_makeContext takes it for 100
      mjr_setBuffer(mjFB_OFFSCREEN, &gl);
      const mjrRect largest = mjr_maxViewport(&gl);
      if (largest.width < width || largest.height < height) {
        throw Error(fmt::format("a picture of {} x {} is too large; at most {} x {} here", width,
                                height, largest.width, largest.height));
      }
      // Each geom, site, contact and so on may need a few visual geoms, each tendon one per
      // segment.
      mjv_makeScene(m, &scene,
                    kMostSticks + 2000 + 4 * (m->ngeom + m->nsite + m->nbody + 4 * m->nwrap));
    } catch (...) {
      mjr_freeContext(&gl);
      throw;
    }
  }

  ~Stage() {
    mjv_freeScene(&scene);
    mjr_freeContext(&gl);
  }
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

  mjvScene scene;
  mjrContext gl;
};

Renderer::Renderer(mjModel* m, int width, int height, std::optional<DiscColours> discs)
    : context_(std::make_unique<Context>()), m_(m), width_(width), height_(height), discs_(discs) {
  m->vis.global.offwidth = width;
  m->vis.global.offheight = height;
  stage_ = std::make_unique<Stage>(m, width, height);
}

Renderer::~Renderer() = default;

std::vector<unsigned char> Renderer::pixels(mjData* d, const mjvOption& option, mjvCamera camera,
                                            const std::vector<Stick>& sticks) {
  const mjModel* m = m_;
  std::optional<DiscSkin> discs;
  if (discs_) {
    // Faces and colours of a skin are constants of the OpenGL context.
    discs.emplace(m_, d, *discs_);
    m = discs->model();
    stage_.reset();
    stage_ = std::make_unique<Stage>(m, width_, height_);
  }
  mjvScene& scene = stage_->scene;
  mjv_updateScene(m, d, &option, nullptr, &camera, mjCAT_ALL, &scene);
  if (discs) discs->place(option, &scene);
  addSticks(sticks, &scene);
  const mjrRect viewport = {0, 0, width_, height_};
  mjr_render(viewport, &scene, &stage_->gl);
  if (discs_) drawLegend(*discs_, viewport, stage_->gl);
  std::vector<unsigned char> rgb(std::size_t{3} * width_ * height_);
  mjr_readPixels(rgb.data(), nullptr, viewport, &stage_->gl);
  return rgb;
}

std::string Renderer::driver() const {
  return reinterpret_cast<const char*>(glGetString(GL_RENDERER));
}

std::string Renderer::png(mjData* d, const mjvOption& option, mjvCamera camera,
                          const std::vector<Stick>& sticks) {
  return encodePng(pixels(d, option, camera, sticks), width_, height_);
}

std::string encodePng(const std::vector<unsigned char>& rgb, int width, int height) {
  png_image image = {};
  image.version = PNG_IMAGE_VERSION;
  image.width = width;
  image.height = height;
  image.format = PNG_FORMAT_RGB;
  const int stride = -3 * width;  // OpenGL's rows go up, PNG's go down
  png_alloc_size_t size = 0;
  std::string content;
  if (png_image_write_get_memory_size(image, size, 0, rgb.data(), stride, nullptr)) {
    content.resize(size);
    if (png_image_write_to_memory(&image, content.data(), &size, 0, rgb.data(), stride, nullptr)) {
      content.resize(size);
      return content;
    }
  }
  throw Error(fmt::format("cannot encode a PNG: {}", image.message));
}

namespace {

struct Layer {
  std::string name;
  int group;
  std::vector<mjtByte (mjvOption::*)[mjNGROUP]> kinds;
};

const std::vector<Layer>& layers() {
  static const std::vector<Layer> all = {
      {"bones", 1, {&mjvOption::geomgroup}},
      {"outline", 2, {&mjvOption::geomgroup}},
      {"collision", 3, {&mjvOption::geomgroup}},
      {"facets", 4, {&mjvOption::geomgroup, &mjvOption::sitegroup}},
      {"ligaments", 1, {&mjvOption::tendongroup}},
      {"discs", 1, {&mjvOption::skingroup}},
  };
  return all;
}

}  // namespace

const std::vector<std::string>& layerNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> result;
    for (const Layer& layer : layers()) result.push_back(layer.name);
    return result;
  }();
  return names;
}

void setVisible(mjvOption& option, const std::string& layer_or_group, bool visible) {
  for (const Layer& layer : layers()) {
    if (layer.name != layer_or_group) continue;
    for (auto kind : layer.kinds) (option.*kind)[layer.group] = visible;
    return;
  }
  struct Kind {
    const char* name;
    mjtByte (mjvOption::*groups)[mjNGROUP];
  };
  static constexpr Kind kKinds[] = {
      {"geom", &mjvOption::geomgroup},         {"site", &mjvOption::sitegroup},
      {"joint", &mjvOption::jointgroup},       {"tendon", &mjvOption::tendongroup},
      {"actuator", &mjvOption::actuatorgroup}, {"skin", &mjvOption::skingroup},
  };
  const std::size_t colon = layer_or_group.find(':');
  for (const Kind& kind : kKinds) {
    if (layer_or_group.substr(0, colon) != kind.name || colon + 2 != layer_or_group.size())
      continue;
    const int group = layer_or_group[colon + 1] - '0';
    if (group < 0 || group >= mjNGROUP) continue;
    (option.*kind.groups)[group] = visible;
    return;
  }
  throw Error(
      fmt::format("no layer or group '{}'; layers: {}; groups: geom:0 to geom:{}, and so "
                  "for site, joint, tendon, actuator and skin",
                  layer_or_group, fmt::join(layerNames(), ", "), mjNGROUP - 1));
}

namespace {

bool isVisible(const mjtByte groups[mjNGROUP], int group) {
  return groups[std::clamp(group, 0, mjNGROUP - 1)] != 0;
}

// Largest dot(direction, x) over the points x of visible body geoms and tendons.
double visibleReach(const mjModel* m, const mjData* d, const mjvOption& option,
                    const mjtNum direction[3]) {
  const auto visible = [&](int g) { return isVisible(option.geomgroup, m->geom_group[g]); };
  double furthest = extent(m, d, direction, visible).max;
  for (int i = 0; i < m->ntendon; i++) {
    if (!isVisible(option.tendongroup, m->tendon_group[i])) continue;
    for (int p = d->ten_wrapadr[i]; p < d->ten_wrapadr[i] + d->ten_wrapnum[i]; p++) {
      furthest = std::max(furthest, mju_dot3(direction, d->wrap_xpos + 3 * p));
    }
  }
  return furthest;
}

}  // namespace

mjvCamera frameBodies(const mjModel* m, const std::vector<const mjData*>& states,
                      const mjvOption& option, double azimuth, double elevation, double aspect,
                      const std::vector<Stick>& sticks) {
  mjvCamera camera;
  mjv_defaultFreeCamera(m, &camera);
  camera.azimuth = azimuth;
  camera.elevation = elevation;

  const double a = azimuth * mjPI / 180, e = elevation * mjPI / 180;
  const mjtNum forward[3] = {std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)};
  const mjtNum right[3] = {std::sin(a), -std::cos(a), 0};
  mjtNum up[3];
  mju_cross(up, right, forward);
  // Furthest point of what is visible along a x + b y.
  const auto reach = [&](double a, const mjtNum x[3], double b, const mjtNum y[3]) {
    const mjtNum direction[3] = {a * x[0] + b * y[0], a * x[1] + b * y[1], a * x[2] + b * y[2]};
    double furthest = -mjMAXVAL;
    for (const mjData* d : states) {
      furthest = std::max(furthest, visibleReach(m, d, option, direction));
    }
    for (const Stick& stick : sticks) {
      for (const Eigen::Vector3d& end : {stick.from, stick.to}) {
        furthest = std::max(furthest, mju_dot3(direction, end.data()));
      }
    }
    return furthest;
  };
  const double front = -reach(-1, forward, 0, up), back = reach(1, forward, 0, up);
  if (front > back) return camera;

  // The planes of the view frustum go through the camera, and where they touch the bodies gives its
  // place: its coordinate across is the middle, the one along is as near as both planes allow.
  const auto touch = [&](const mjtNum across[3], double half_angle, double& middle) {
    const double c = std::cos(half_angle), s = std::sin(half_angle);
    const double one = reach(c, across, -s, forward), other = reach(-c, across, -s, forward);
    middle = (one - other) / (2 * c);
    return -(one + other) / (2 * s);
  };
  constexpr double kMargin = 0.92;  // of the picture is filled
  const double tangent = kMargin * std::tan(m->vis.global.fovy * mjPI / 360);
  double x, y;
  const double position =
      std::min(touch(right, std::atan(aspect * tangent), x), touch(up, std::atan(tangent), y));
  const double middle = (front + back) / 2;
  camera.distance = middle - position;
  for (int i = 0; i < 3; i++) camera.lookat[i] = x * right[i] + y * up[i] + middle * forward[i];
  return camera;
}

}  // namespace torso::tools
