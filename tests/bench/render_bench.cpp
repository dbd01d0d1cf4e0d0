// Speed of grid tracing, on one thread:
//
//   render/rays/SIZE           primary rays of the three-quarter view
//   render/near/SIZE           primary rays of a camera over the southern rim that looks north
//   render/rays_embree/SIZE    the same rays through Embree, single rays, if it was found by CMake
//   render/near_embree/SIZE
//   render/tree/SIZE           making the surface and its tree
//   render/view/SIZE           a whole picture of 640 x 360, 4 rays for a pixel, with shadows
//
//   rays_per_second  primary rays over CPU time; the growth of the time with SIZE is what they cost
//
// 1025 is Mount Washington when DEM_TESTDATA says where its tile is, the others are fractals.
// Example: build/release/tests/bench/render_bench --benchmark_filter='render/rays.*'

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cstdlib>
#include <iostream>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "dem/io/rasters.h"
#include "dem/mcmd.h"
#include "dem/raytrace.h"

#ifdef DEM_EMBREE
#include <embree3/rtcore.h>
#endif

namespace {

constexpr int kWidth = 640, kHeight = 360;
const dem::Run one_thread{.threads = 1, .progress = {}};

std::string mount_washington() {
  const char* folder = std::getenv("DEM_TESTDATA");
  return folder ? std::string(folder) + "/mtwashington_1025_3s.tif" : "";
}

/// Mount Washington, or the noise of midpoint displacement with about the roughness of mountains.
dem::Dem make_terrain(int side) {
  if (side == 1025 && !mount_washington().empty()) return dem::read_dem(mount_washington()).dem;
  dem::Dem dem{dem::Raster<float>({side, side}), dem::Mask({side, side}), {}, {30, 30}};
  dem.z = dem::fill_md(dem, {.H = 0, .rs = 0.5, .seed = 7}, one_thread);
  dem.known = dem::Mask({side, side}, 1);
  return dem;
}

const dem::Dem& terrain(int side) {
  static std::map<int, dem::Dem> made;
  auto found = made.find(side);
  if (found == made.end()) found = made.emplace(side, make_terrain(side)).first;
  return found->second;
}

/// The view whose rays are measured: with the exaggeration of a three-quarter view in both.
dem::View view(const dem::Dem& dem, bool near) {
  dem::View view = dem::make_view(dem);
  if (!near) return view;
  dem::ViewOptions o;
  const auto [dx, dy] = dem.spacing;
  const double x = dem.z.cols() * dx / 2, y = -dem.z.rows() * dy * 0.95;
  const double ground = view.ground.height(x, y).value_or(0) / view.exaggeration;
  o.exaggeration = view.exaggeration;
  o.fov_deg = 60;
  o.camera = dem::Vec3{x, y, ground + 10 * dx / view.exaggeration};
  o.target = dem::Vec3{x, 0, ground};
  return dem::make_view(dem, o);
}

std::vector<dem::Ray> primary_rays(const dem::Camera& camera) {
  std::vector<dem::Ray> rays;
  for (int row = 0; row < kHeight; ++row)
    for (int col = 0; col < kWidth; ++col)
      rays.push_back(camera.ray((2 * col + 1.0) / kWidth - 1, 1 - (2 * row + 1.0) / kHeight));
  return rays;
}

void count_rays(benchmark::State& state, std::size_t rays) {
  state.counters["rays_per_second"] =
      benchmark::Counter(double(rays) * double(state.iterations()), benchmark::Counter::kIsRate);
}

void bench_rays(benchmark::State& state, int side, bool near) {
  const dem::View v = view(terrain(side), near);
  const auto rays = primary_rays(v.camera);
  std::size_t hits = 0;
  for (auto _ : state) {
    hits = 0;
    for (const auto& ray : rays) hits += v.ground.intersect(ray).has_value();
    benchmark::DoNotOptimize(hits);
  }
  count_rays(state, rays.size());
  state.counters["hits"] = double(hits) / double(rays.size());
}

#ifdef DEM_EMBREE
/// The triangles of a DEM in Embree, four corners to a square shared.
RTCScene embree_scene(RTCDevice device, const dem::Dem& dem, double exaggeration) {
  const auto scene = rtcNewScene(device);
  const auto mesh = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  const auto cols = unsigned(dem.z.cols()), rows = unsigned(dem.z.rows());
  auto* p = static_cast<float*>(rtcSetNewGeometryBuffer(
      mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), dem.size().cells()));
  for (int row = 0; row < dem.z.rows(); ++row)
    for (int col = 0; col < dem.z.cols(); ++col) {
      *p++ = float(col * dem.spacing.dx_m);
      *p++ = float(-row * dem.spacing.dy_m);
      *p++ = float(exaggeration * double(dem.z(col, row)));
    }
  auto* corner = static_cast<unsigned*>(
      rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                              3 * sizeof(unsigned), 2ULL * (cols - 1) * (rows - 1)));
  for (unsigned row = 0; row + 1 < rows; ++row)
    for (unsigned col = 0; col + 1 < cols; ++col) {
      const unsigned a = row * cols + col, d = a + cols;
      for (const unsigned k : {a, d + 1, a + 1, a, d, d + 1}) *corner++ = k;
    }
  rtcCommitGeometry(mesh);
  rtcAttachGeometry(scene, mesh);
  rtcReleaseGeometry(mesh);
  rtcCommitScene(scene);
  return scene;
}

void bench_embree(benchmark::State& state, int side, bool near) {
  const dem::View v = view(terrain(side), near);
  const auto rays = primary_rays(v.camera);
  const auto device = rtcNewDevice("threads=1");
  const auto scene = embree_scene(device, terrain(side), v.exaggeration);
  std::size_t hits = 0;
  for (auto _ : state) {
    hits = 0;
    for (const auto& ray : rays) {
      RTCRayHit r{};
      r.ray.org_x = float(ray.origin.x), r.ray.org_y = float(ray.origin.y);
      r.ray.org_z = float(ray.origin.z), r.ray.dir_x = float(ray.direction.x);
      r.ray.dir_y = float(ray.direction.y), r.ray.dir_z = float(ray.direction.z);
      r.ray.tfar = std::numeric_limits<float>::infinity();
      r.ray.mask = ~0u;
      r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      RTCIntersectContext context;
      rtcInitIntersectContext(&context);
      rtcIntersect1(scene, &context, &r);
      hits += r.hit.geomID != RTC_INVALID_GEOMETRY_ID;
    }
    benchmark::DoNotOptimize(hits);
  }
  count_rays(state, rays.size());
  state.counters["hits"] = double(hits) / double(rays.size());
  rtcReleaseScene(scene);
  rtcReleaseDevice(device);
}
#endif

void bench_tree(benchmark::State& state, int side) {
  const dem::Dem& dem = terrain(side);
  for (auto _ : state) benchmark::DoNotOptimize(dem::Heightfield(dem));
}

void bench_view(benchmark::State& state, int side) {
  dem::ViewOptions o;
  o.width = kWidth, o.height = kHeight;
  for (auto _ : state) benchmark::DoNotOptimize(dem::render_view(terrain(side), o, one_thread));
  count_rays(state, std::size_t(o.samples) * kWidth * kHeight);
}

}  // namespace

int main(int argc, char** argv) {
  const auto add = [](const std::string& name, int side, auto bench) {
    benchmark::RegisterBenchmark(fmt::format("render/{}/{}", name, side).c_str(), bench)
        ->Unit(benchmark::kMillisecond);
  };
  for (const int side : {257, 1025, 4097}) {
    for (const bool near : {false, true}) {
      const std::string name = near ? "near" : "rays";
      add(name, side, [=](benchmark::State& state) { bench_rays(state, side, near); });
#ifdef DEM_EMBREE
      add(name + "_embree", side,
          [=](benchmark::State& state) { bench_embree(state, side, near); });
#endif
    }
    add("tree", side, [=](benchmark::State& state) { bench_tree(state, side); });
    add("view", side, [=](benchmark::State& state) { bench_view(state, side); });
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  if (mount_washington().empty())
    std::cerr << "DEM_TESTDATA is not set: 1025 x 1025 is a fractal, not Mount Washington\n";
  benchmark::RunSpecifiedBenchmarks();
}
