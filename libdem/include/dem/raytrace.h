#pragma once
// Perspective views of terrain by grid tracing [musgrave1989].
//
// Coordinates are metres: x east, y north, z up. The centre of cell (0, 0) is x = y = 0, so the
// cell (col, row) stands at x = col * dx_m, y = -row * dy_m, z = its elevation.

#include <limits>
#include <optional>
#include <vector>

#include "dem/dem.h"
#include "dem/fields.h"
#include "dem/palette.h"
#include "dem/run.h"

namespace dem {

struct Vec3 {
  double x = 0, y = 0, z = 0;

  bool operator==(const Vec3&) const = default;
};

constexpr Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
constexpr Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
constexpr Vec3 operator*(double s, Vec3 v) { return {s * v.x, s * v.y, s * v.z}; }
constexpr double dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/// The points origin + t * direction for 0 <= t <= t_max. The direction has any length except 0.
struct Ray {
  Vec3 origin;
  Vec3 direction;
  double t_max = std::numeric_limits<double>::infinity();
};

/// Where a ray first meets the ground.
struct Hit {
  double t = 0;
  int col = 0, row = 0;  ///< the square between the cells (col, row) and (col + 1, row + 1)
  Vec3 normal;           ///< of the triangle that was hit, upwards, of length 1
};

/// A surface of two triangles between each four neighbouring cells, split from north west to south
/// east, with the tree in which rays find it. A triangle with an unknown corner is a hole that rays
/// pass. A square with one unknown corner keeps the triangle of the other three.
///
/// Method: grid tracing [musgrave1989] section 5: a DDA through squares, over a tree of 4 x 4 grids
///         that hold the lowest and the highest ground below them. Departures: there is no stack,
///         and the walk goes up a level when it leaves a grid. A hit is a change of sign of the
///         height of the ray above ground along the walk, so no ray passes between two triangles.
///         Both sides of the ground stop a ray.
/// Needs:  at least 2 x 2 cells. The DEM may be destroyed once the surface exists.
/// Gives:  heights multiplied by `exaggeration`. Every z of this class is such a height.
/// Cost:   5 bytes a cell. A ray visits O(log cells) grids where the ground is far below it, and
///         never more than O(sqrt(cells)) squares.
/// Throws: std::invalid_argument for fewer cells, a spacing or an exaggeration that is not > 0, or
///         a known height that is not finite.
class Heightfield {
 public:
  explicit Heightfield(const Dem& dem, double exaggeration = 1);

  /// The first point of the ray on the ground. Touching counts.
  std::optional<Hit> intersect(const Ray& ray) const;

  /// Whether the ground blocks the ray: intersect() without the point.
  bool blocks(const Ray& ray) const;

  /// The height of the ground below or above (x, y); nothing in a hole or outside the terrain.
  std::optional<double> height(double x, double y) const;

  Size size() const { return z_.size(); }
  Spacing spacing() const { return spacing_; }

  /// The lowest and the highest ground of all triangles; low > high when there is no triangle.
  double low() const { return low_; }
  double high() const { return high_; }

 private:
  struct Bounds {
    float low = std::numeric_limits<float>::infinity(), high = -low;
  };
  struct Walk;

  void build_tree();
  bool trace(const Ray& ray, Walk& walk) const;

  Raster<float> z_;  // NaN where unknown
  Spacing spacing_;
  std::vector<Raster<Bounds>>
      tree_;  // [0]: grids of 4 x 4 squares, [1]: grids of 4 x 4 of those ...
  bool has_holes_ = false;
  double low_ = 0, high_ = 0;
};

/// What a view shows, and from where. Without a camera it shows the whole terrain from outside and
/// above, as a block cut out of the ground: a three-quarter view.
struct ViewOptions {
  int width = 1600, height = 900;  ///< pixels
  int samples = 4;                 ///< number of rays for a pixel
  double azimuth_deg = 305;        ///< where the sun stands, clockwise from north
  double altitude_deg = 35;
  double exaggeration = 0;  ///< 0: 1 with a camera, else chosen so that the relief shows
  double heading_deg = 25;  ///< direction of the three-quarter view, clockwise from north
  double tilt_deg = 32;     ///< how far it looks down
  double fov_deg = 32;      ///< angle across the picture's width
  double haze = 1;          ///< 0: clear air; 1: ground that is the length of the terrain away
                            ///< fades: a little in a three-quarter view, mostly for a camera
  bool shadows = true;
  Palette palette = Palette::atlas;
  bool sea = false;  ///< heights at or below 0 are water

  /// Where the camera stands and what it looks at, before heights are exaggerated. Without a target
  /// it looks at the middle of the terrain.
  std::optional<Vec3> camera = {}, target = {};
};
std::vector<Field> fields(ViewOptions& options);

/// A pinhole camera. x and y of a picture run from -1 to 1, to the right and upwards.
struct Camera {
  Vec3 position, forward;  ///< forward has length 1
  Vec3 right, up;          ///< to the edges of the picture

  Ray ray(double x, double y) const { return {position, forward + x * right + y * up}; }
};

/// The surface and the camera of a view.
struct View {
  double exaggeration = 1;
  Heightfield ground;
  Camera camera;
};

/// Throws std::invalid_argument, also when the camera stands under the ground.
View make_view(const Dem& dem, const ViewOptions& options = {});

/// A perspective view.
/// Method: grid tracing [musgrave1989]. The ground has the colours of the palette and normals that
///         change evenly from cell to cell. The sun lights it, and its shadows are traced. In
///         addition, the part of the sky that each cell sees above its horizon in 16 directions
///         lights it. Air removes colour exponentially with the distance through it. The terrain
///         stands on a plain, and its cut sides are drawn. Sub-pixel positions are hashes of the
///         pixel: the number of threads does not change a bit.
/// Needs:  at least 2 x 2 cells. Unknown cells are holes through which the inside of the block is
///         seen.
/// Throws: std::invalid_argument, Cancelled.
Raster<Rgb> render_view(const Dem& dem, const ViewOptions& options = {}, const Run& run = {});

}  // namespace dem
