#include "dem/hole_parts.h"

#include <gtest/gtest.h>

#include <cmath>

#include "numeric/random.h"

namespace dem {
using namespace numeric;
namespace {

/// Random holes of some share of the cells, in blobs of `blob` cells across; heights differ.
Dem holed(Size size, double share, int blob, std::uint64_t seed) {
  Dem dem{Raster<float>(size), Mask(size, 1), {}, {}};
  for (int row = 0; row < size.rows; ++row)
    for (int col = 0; col < size.cols; ++col) {
      dem.z(col, row) = float(random_bits(seed, 1, col, row) % 1000) / 7;
      dem.known(col, row) =
          double(random_bits(seed, 0, col / blob, row / blob) % 100000) >= share * 100000;
    }
  return dem;
}

std::vector<Spacing> spacing_of(int rows) {
  std::vector<Spacing> spacing;
  for (int row = 0; row < rows; ++row) spacing.push_back({20 + std::sqrt(row), 31});
  return spacing;
}

/// Everything in a Hole, doubles bit for bit.
std::vector<double> numbers(const Hole& h) {
  return {double(h.box.col),   double(h.box.row), double(h.box.cols),  double(h.box.rows),
          double(h.first_col), double(h.cells),   double(h.at_border), double(h.has_rim),
          h.area_m2,           h.distance_m,      h.rim_low_m,         h.rim_high_m,
          h.rim_mean_m};
}

std::vector<std::vector<double>> numbers(const std::vector<Hole>& holes) {
  std::vector<std::vector<double>> all;
  for (const Hole& hole : holes) all.push_back(numbers(hole));
  return all;
}

/// The holes by parts of so many cells, the last ones taken first.
std::vector<Hole> by_parts(const Dem& dem, const std::vector<Spacing>& spacing, int cols,
                           int rows) {
  const Size size = dem.size();
  std::vector<HolePart> parts;
  for (int row = 0; row < size.rows; row += rows)
    for (int col = 0; col < size.cols; col += cols) {
      const Box part{col, row, std::min(cols, size.cols - col), std::min(rows, size.rows - row)};
      parts.insert(parts.begin(),
                   scan_part(crop(dem, with_ring(part, size), {}), part, size, spacing));
    }
  return join_parts(parts, size, spacing);
}

TEST(HoleParts, GiveTheHolesOfTheWholeBitForBit) {
  const Size size{43, 37};
  const auto spacing = spacing_of(size.rows);
  for (const double share : {0.0, 0.02, 0.3, 0.5, 0.97, 1.0})
    for (const int blob : {1, 5}) {
      const Dem dem = holed(size, share, blob, 7);
      const auto whole = numbers(find_holes(dem, spacing));
      for (const auto& [cols, rows] : {std::pair{43, 37}, {20, 37}, {43, 9}, {7, 5}, {3, 1}})
        EXPECT_EQ(numbers(by_parts(dem, spacing, cols, rows)), whole)
            << share << ' ' << blob << ' ' << cols << ' ' << rows;
    }
}

TEST(HoleParts, CountKnownCellsOfThePartOnly) {
  const Dem dem = holed({20, 10}, 0.3, 1, 3);
  std::size_t known = 0;
  for (const int col : {0, 10}) {
    const Box part{col, 0, 10, 10};
    known += scan_part(crop(dem, with_ring(part, dem.size()), {}), part, dem.size(), spacing_of(10))
                 .known_cells;
  }
  EXPECT_EQ(known, count(dem.known));
}

TEST(HoleParts, ThatDoNotFitAreRefused) {
  const Dem dem = holed({20, 10}, 0.3, 1, 3);
  EXPECT_THROW(scan_part(dem, {0, 0, 10, 10}, {20, 10}, spacing_of(10)), std::logic_error);
}

}  // namespace
}  // namespace dem
