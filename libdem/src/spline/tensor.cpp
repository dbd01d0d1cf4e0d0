#include "spline/tensor.h"

#include <cmath>
#include <numbers>

#include "numeric/parallel.h"
#include "spline/multigrid.h"

namespace dem::spline {
using namespace numeric;
namespace {

constexpr double mix = 0.95;         // the rest is C_iso
constexpr double floor_part = 1e-3;  // of the mean trace: where the surface is flat, W = 1

// W's eigenvalues lie between 0.34 and 27, so steps of 1 / 1000 change nothing that matters.
constexpr float step = 1e-3f;

DEM_INLINE inline Tensor::Weight rounded(float weight) {
  return Tensor::Weight(weight * (1 / step) + (weight < 0 ? -0.5f : 0.5f));
}

/// Second differences of one row in orthonormal coordinates, from the rows above and below.
template <class T>
DEM_INLINE inline void bends(const T* up, const T* here, const T* down, float X, float root_2X,
                             int x, float (&h)[3]) {
  h[0] = X * float(here[x - 1] - 2 * here[x] + here[x + 1]);
  h[1] = root_2X * 0.25f * float((up[x - 1] - up[x + 1]) + (down[x + 1] - down[x - 1]));
  h[2] = float(up[x] - 2 * here[x] + down[x]);
}

/// The six products h h^T of one row.
DEM_VECTORISED void products_row(const double* up, const double* here, const double* down, float X,
                                 float root_2X, int begin, int end, float* const* out) {
  float *p0 = out[0], *p1 = out[1], *p2 = out[2], *p3 = out[3], *p4 = out[4], *p5 = out[5];
  DEM_INDEPENDENT
  for (int x = begin; x < end; ++x) {
    float h[3];
    bends(up, here, down, X, root_2X, x, h);
    p0[x] = h[0] * h[0];
    p1[x] = h[0] * h[1];
    p2[x] = h[0] * h[2];
    p3[x] = h[1] * h[1];
    p4[x] = h[1] * h[2];
    p5[x] = h[2] * h[2];
  }
}

DEM_VECTORISED void add_scaled(const float* in, float weight, int begin, int end, float* out) {
  DEM_INDEPENDENT
  for (int x = begin; x < end; ++x) out[x] += weight * in[x];
}

/// out = sum over |k| <= radius of weight[|k|] in[x + k].
DEM_VECTORISED void blur_row(const float* in, const float* weight, int radius, int begin, int end,
                             float* out) {
  for (int x = begin; x < end; ++x) out[x] = weight[0] * in[x];
  for (int k = 1; k <= radius; ++k) {
    const float w = weight[k];
    DEM_INDEPENDENT
    for (int x = begin; x < end; ++x) out[x] += w * (in[x - k] + in[x + k]);
  }
}

/// W - 1 of one row from the blurred products.
DEM_VECTORISED void weights_row(const float* const* c, float floor, int begin, int end,
                                Tensor::Weight* const* w) {
  const float *c0 = c[0], *c1 = c[1], *c2 = c[2], *c3 = c[3], *c4 = c[4], *c5 = c[5];
  Tensor::Weight *w0 = w[0], *w1 = w[1], *w2 = w[2], *w3 = w[3], *w4 = w[4], *w5 = w[5];
  DEM_INDEPENDENT
  for (int x = begin; x < end; ++x) {
    // C' = mix C / trace + (1 - mix) C_iso; C_iso = 3/8 1/8 on the ends, 1/4 in the middle.
    const float trace = c0[x] + c3[x] + c5[x] + floor;
    const float scale = float(mix) / trace;
    const float iso = 1 - float(mix) * (trace - floor) / trace;
    const float a = scale * c0[x] + iso * 0.375f, b = scale * c1[x],
                d = scale * c2[x] + iso * 0.125f;
    const float e = scale * c3[x] + iso * 0.25f, f = scale * c4[x],
                g = scale * c5[x] + iso * 0.375f;
    // Inverse by cofactors, over 3.
    const float aa = e * g - f * f, ab = d * f - b * g, ad = b * f - d * e;
    const float third = 1 / (3 * (a * aa + b * ab + d * ad));
    w0[x] = rounded(aa * third - 1);
    w1[x] = rounded(ab * third);
    w2[x] = rounded(ad * third);
    w3[x] = rounded((a * g - d * d) * third - 1);
    w4[x] = rounded((b * d - a * f) * third);
    w5[x] = rounded((a * e - b * b) * third - 1);
  }
}

/// Moments of the cells of one row: along x, along y, and their share of the corners.
template <class T>
DEM_INLINE inline void moments(const T* up, const T* here, const T* down,
                               const Tensor::Weight* const* w, float X, float root_2X, Span span,
                               float* along_x, float* along_y, float* twist) {
  const Tensor::Weight *w0 = w[0], *w1 = w[1], *w2 = w[2], *w4 = w[4], *w5 = w[5];
  const float step_x = step * X, step_twist = step * 0.25f * root_2X;
  DEM_INDEPENDENT
  for (int x = span.begin; x < span.end; ++x) {
    float h[3];
    bends(up, here, down, X, root_2X, x, h);
    const float xx_xy = float(w1[x]), xx_yy = float(w2[x]), xy_yy = float(w4[x]);
    along_x[x] = step_x * (float(w0[x]) * h[0] + xx_xy * h[1] + xx_yy * h[2]);
    along_y[x] = step * (xx_yy * h[0] + xy_yy * h[1] + float(w5[x]) * h[2]);
    twist[x] = step_twist * (xx_xy * h[0] + xy_yy * h[2]);
  }
}
DEM_VECTORISED void moments_row(const float* up, const float* here, const float* down,
                                const Tensor::Weight* const* w, float X, float root_2X, Span span,
                                float* along_x, float* along_y, float* twist) {
  moments(up, here, down, w, X, root_2X, span, along_x, along_y, twist);
}
DEM_VECTORISED void moments_row(const double* up, const double* here, const double* down,
                                const Tensor::Weight* const* w, float X, float root_2X, Span span,
                                float* along_x, float* along_y, float* twist) {
  moments(up, here, down, w, X, root_2X, span, along_x, along_y, twist);
}

/// Moments at the corners (x + 1/2, y + 1/2) between two rows.
template <class T>
DEM_INLINE inline void corners(const T* here, const T* below, const float* twist,
                               const float* twist_below, const Tensor::Weight* w,
                               const Tensor::Weight* w_below, float half_X, Span span, float* out) {
  DEM_INDEPENDENT
  for (int x = span.begin; x < span.end; ++x) {
    const float q = float((below[x + 1] - below[x]) - (here[x + 1] - here[x]));
    const float weight = half_X * float(w[x] + w[x + 1] + w_below[x] + w_below[x + 1]);
    out[x] = (twist[x] + twist[x + 1]) + (twist_below[x] + twist_below[x + 1]) + weight * q;
  }
}
DEM_VECTORISED void corners_row(const float* here, const float* below, const float* twist,
                                const float* twist_below, const Tensor::Weight* w,
                                const Tensor::Weight* w_below, float half_X, Span span,
                                float* out) {
  corners(here, below, twist, twist_below, w, w_below, half_X, span, out);
}
DEM_VECTORISED void corners_row(const double* here, const double* below, const float* twist,
                                const float* twist_below, const Tensor::Weight* w,
                                const Tensor::Weight* w_below, float half_X, Span span,
                                float* out) {
  corners(here, below, twist, twist_below, w, w_below, half_X, span, out);
}

/// What the moments around a row pull its free cells with.
DEM_VECTORISED void pull_row(const float* along_x, const float* y_up, const float* y_here,
                             const float* y_down, const float* corner_up, const float* corner_down,
                             float sign, const float* dinv, Span span, float* out) {
  DEM_INDEPENDENT
  for (int x = span.begin; x < span.end; ++x) {
    const float straight =
        (along_x[x - 1] - 2 * along_x[x] + along_x[x + 1]) + (y_up[x] - 2 * y_here[x] + y_down[x]);
    const float twisted = (corner_up[x - 1] - corner_up[x]) + (corner_down[x] - corner_down[x - 1]);
    const float sum = out[x] + sign * (straight + twisted);
    out[x] = dinv[x] != 0 ? sum : 0;
  }
}

/// Rows found modulo 4.
class Ring4 {
 public:
  explicit Ring4(int cols)
      : stride_(std::size_t(Grid<float>::stride_for(cols))), cells_(4 * stride_) {}
  float* row(int y) { return cells_.data() + std::size_t(y & 3) * stride_ + Grid<float>::margin; }

 private:
  std::size_t stride_;
  std::vector<float> cells_;
};

template <class Work>
void in_row_bands(int rows, const Work& work) {
  const int bands = std::max(1, std::min(tbb::this_task_arena::max_concurrency(), rows / 64));
  parallel_for(0, bands, 1, [&](int i) {
    work(int(std::int64_t(rows) * i / bands), int(std::int64_t(rows) * (i + 1) / bands));
  });
}

}  // namespace

Tensor::Tensor(Size size, const Spans& spans, double X, const Mask& breaks)
    : size_(size), spans_(spans), X_(X) {
  if (!breaks.empty()) broken_ = cells_near_breaks(breaks, 1);
  for (auto& w : w_) w = Grid<Weight>(size);
  std::vector<Span> parts;
  for (int y = 0; y < size.rows; ++y) {
    parts.clear();
    for (int near = std::max(0, y - 1); near <= std::min(size.rows - 1, y + 1); ++near)
      for (const Span s : spans.row(near))
        parts.push_back({std::max(0, s.begin - 1), std::min(size.cols, s.end + 1)});
    std::sort(parts.begin(), parts.end(), [](Span a, Span b) { return a.begin < b.begin; });
    around_.add_row(parts, size.cols);
  }
}

void Tensor::estimate(const Grid<double>& z, double sigma) {
  const int cols = size_.cols, rows = size_.rows;
  if (cols < 3 || rows < 3) return;
  const int radius = std::clamp(int(std::ceil(2.5 * sigma)), 1, 40);
  std::vector<float> weight;
  double total = 0;
  for (int k = 0; k <= radius; ++k) {
    weight.push_back(float(std::exp(-0.5 * k * k / (sigma * sigma))));
    total += (k == 0 ? 1 : 2) * double(weight.back());
  }
  for (float& w : weight) w = float(double(w) / total);
  const float X = float(X_), root_2X = float(std::sqrt(2 * X_));

  // The mean trace, for the floor: row sums in order.
  std::vector<double> traces(std::size_t(rows), 0.), counts(std::size_t(rows), 0.);
  parallel_for(1, rows - 1, 16, [&](int y) {
    for (const Span s : around_.row(y))
      for (int x = std::max(1, s.begin); x < std::min(cols - 1, s.end); ++x) {
        float h[3];
        bends(z.row(y - 1), z.row(y), z.row(y + 1), X, root_2X, x, h);
        traces[std::size_t(y)] += double(h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);
        ++counts[std::size_t(y)];
      }
  });
  double trace = 0, cells = 0;
  for (int y = 0; y < rows; ++y) trace += traces[std::size_t(y)], cells += counts[std::size_t(y)];
  if (!(trace > 0)) {
    for (auto& w : w_) w = Grid<Weight>(size_);
    return;
  }
  const float floor = float(std::max(floor_part * trace / cells, 1e-30));

  in_row_bands(rows, [&](int y0, int y1) {
    // Products of the rows within reach, found modulo `depth`; a margin wide enough for the blur.
    const int depth = 2 * radius + 1, margin = (radius + 15) / 8 * 8;
    const std::size_t stride = std::size_t(cols + 2 * margin + 16);
    std::vector<float> ring(stride * 6 * std::size_t(depth)), sums(stride * 6), blurred(stride * 6);
    const auto plane = [&](std::vector<float>& from, std::size_t slot, int i) {
      return from.data() + (slot * 6 + std::size_t(i)) * stride + margin;
    };
    const auto make_products = [&](int y) {
      const int at = std::clamp(y, 1, rows - 2);
      std::array<float*, 6> out;
      for (int i = 0; i < 6; ++i)
        out[std::size_t(i)] = plane(ring, std::size_t((y + depth) % depth), i);
      products_row(z.row(at - 1), z.row(at), z.row(at + 1), X, root_2X, 1, cols - 1, out.data());
      if (!broken_.empty())
        for (const int x : broken_[std::size_t(at)])
          for (float* row : out) row[x] = 0;
      for (float* row : out) {
        std::fill(row - margin, row + 1, row[1]);
        std::fill(row + cols - 1, row + cols + margin, row[cols - 2]);
      }
    };
    const auto in_grid = [&](int y) { return std::clamp(y, -radius, rows - 1 + radius); };
    for (int y = y0 - radius; y < y0 + radius; ++y) make_products(in_grid(y));
    for (int y = y0; y < y1; ++y) {
      make_products(y + radius);
      if (y == 0 || y == rows - 1) continue;
      std::array<const float*, 6> c;
      std::array<Weight*, 6> w;
      for (int i = 0; i < 6; ++i) {
        c[std::size_t(i)] = plane(blurred, 0, i);
        w[std::size_t(i)] = w_[std::size_t(i)].row(y);
      }
      for (const Span s : around_.row(y)) {
        const int begin = std::max(1, s.begin), end = std::min(cols - 1, s.end);
        for (int i = 0; i < 6; ++i) {
          float* sum = plane(sums, 0, i);
          std::fill(sum + begin - radius, sum + end + radius, 0.f);
          for (int k = -radius; k <= radius; ++k)
            add_scaled(plane(ring, std::size_t((y + k + depth) % depth), i),
                       weight[std::size_t(std::abs(k))], begin - radius, end + radius, sum);
          blur_row(sum, weight.data(), radius, begin, end, plane(blurred, 0, i));
        }
        weights_row(c.data(), floor, begin, end, w.data());
      }
      if (!broken_.empty())
        for (const int x : broken_[std::size_t(y)])
          for (Weight* row : w) row[x] = 0;
    }
  });
}

template <class T>
void Tensor::add_to(const Grid<T>& u, float sign, const Grid<float>& dinv, Grid<float>& out) const {
  const int cols = size_.cols, rows = size_.rows;
  if (cols < 3 || rows < 3) return;
  const float X = float(X_), root_2X = float(std::sqrt(2 * X_)), half_X = float(X_ / 2) * step;
  in_row_bands(rows, [&](int y0, int y1) {
    Ring4 along_x(cols), along_y(cols), twist(cols), corner(cols);
    const auto make_moments = [&](int y) {
      const auto spans = y >= 0 && y < rows ? around_.row(y) : std::span<const Span>();
      for (Ring4* ring : {&along_x, &along_y, &twist}) clear_gaps(ring->row(y), spans, cols);
      if (spans.empty()) return;
      if (y == 0 || y == rows - 1) {
        for (Ring4* ring : {&along_x, &along_y, &twist}) clear_gaps(ring->row(y), {}, cols);
        return;
      }
      std::array<const Weight*, 6> w;
      for (std::size_t i = 0; i < 6; ++i) w[i] = w_[i].row(y);
      for (const Span s : spans)
        moments_row(u.row(y - 1), u.row(y), u.row(y + 1), w.data(), X, root_2X, s, along_x.row(y),
                    along_y.row(y), twist.row(y));
    };
    const auto make_corners = [&](int y) {  // between rows y and y + 1
      const auto spans = y >= 0 && y + 1 < rows ? around_.row(y) : std::span<const Span>();
      clear_gaps(corner.row(y), spans, cols);
      for (const Span s : spans)
        corners_row(u.row(y), u.row(y + 1), twist.row(y), twist.row(y + 1), w_[3].row(y),
                    w_[3].row(y + 1), half_X, {s.begin, std::min(s.end, cols - 1)}, corner.row(y));
      if (!spans.empty() && spans.back().end == cols) corner.row(y)[cols - 1] = 0;
    };
    make_moments(y0 - 1);
    make_moments(y0);
    make_corners(y0 - 1);
    for (int y = y0; y < y1; ++y) {
      make_moments(y + 1);
      make_corners(y);
      for (const Span s : spans_.row(y))
        pull_row(along_x.row(y), along_y.row(y - 1), along_y.row(y), along_y.row(y + 1),
                 corner.row(y - 1), corner.row(y), sign, dinv.row(y), s, out.row(y));
    }
  });
}

void Tensor::add(const Grid<float>& u, float sign, const Grid<float>& dinv,
                 Grid<float>& out) const {
  add_to(u, sign, dinv, out);
}
void Tensor::add(const Grid<double>& u, float sign, const Grid<float>& dinv,
                 Grid<float>& out) const {
  add_to(u, sign, dinv, out);
}

}  // namespace dem::spline
