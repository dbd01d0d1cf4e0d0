#pragma once
// One line of an exact distance transform. Private to the library.

#include <cstddef>
#include <limits>
#include <vector>

namespace dem {

/// Lower envelope of parabolas: replaces f(i) by the least f(j) + (step (i - j))^2.
/// Method: [felzenszwalb2012].
class Envelope {
 public:
  static constexpr double infinite = std::numeric_limits<double>::infinity();

  void apply(std::vector<double>& f, double step) {
    const int n = int(f.size());
    at_.resize(f.size());
    from_.resize(f.size() + 1);
    int k = -1;
    const double s2 = step * step;
    for (int q = 0; q < n; ++q) {
      if (f[std::size_t(q)] == infinite) continue;
      double s = -infinite;
      while (k >= 0) {
        const int p = at_[std::size_t(k)];
        s = ((f[std::size_t(q)] - f[std::size_t(p)]) / s2 + double(q) * q - double(p) * p) /
            (2. * (q - p));
        if (s > from_[std::size_t(k)]) break;
        --k;
      }
      ++k;
      at_[std::size_t(k)] = q;
      from_[std::size_t(k)] = k == 0 ? -infinite : s;
    }
    if (k < 0) return;
    const int last = k;
    out_.resize(f.size());
    k = 0;
    for (int i = 0; i < n; ++i) {
      while (k < last && from_[std::size_t(k) + 1] < i) ++k;
      const int p = at_[std::size_t(k)];
      out_[std::size_t(i)] = f[std::size_t(p)] + s2 * double(i - p) * double(i - p);
    }
    f.swap(out_);
  }

 private:
  std::vector<int> at_;
  std::vector<double> from_, out_;
};

}  // namespace dem
