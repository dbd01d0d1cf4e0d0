#include "io/fill/fill_memory.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include "dem/io/fill_job.h"

namespace dem::io {

std::size_t bytes_a_cell(const FillOptions& options, const FillFiles& files) {
  return options.method.method->traits.bytes_per_cell.value + (options.sigma ? 30 : 0) +
         (options.rim_errors ? 10 : 0) + files.aux.size() * 30 + (files.water.empty() ? 0 : 4);
}

std::size_t block_cache(std::size_t memory) { return std::min(memory / 6, 256 * mega); }

FillRaster raster_of(RasterReader& reader, const std::vector<Spacing>& spacing) {
  return {reader.size(), lattice_origin(reader.ref()), [&](const Box& box) {
            Dem dem = reader.read(box);
            dem.spacing = spacing[std::size_t(box.row + box.rows / 2)];
            return dem;
          }};
}

}  // namespace dem::io

namespace dem {
using namespace io;

std::string text_of_bytes(std::size_t bytes) {
  return bytes >= 1024 * mega ? fmt::format("{:.1f}G", double(bytes) / (1024. * mega))
                              : fmt::format("{}M", (bytes + mega - 1) / mega);
}

std::size_t parse_memory(std::string_view what, const std::string& text) {
  double number = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  double bytes = error == std::errc() ? number : NAN;
  if (rest + 1 == end) {
    const auto power = std::string_view("bkmgBKMG").find(*rest);
    bytes = power == std::string_view::npos ? NAN : bytes * std::pow(1024., double(power % 4));
  } else if (rest != end) {
    bytes = NAN;
  }
  if (!(bytes >= 1 && bytes < 1e18))
    throw std::invalid_argument(
        fmt::format("{} = {}; must be a size above 0, e.g. 2G, 500M", what, text));
  return std::size_t(bytes);
}

std::size_t machine_memory() {
  const long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGE_SIZE);
  return pages > 0 && size > 0 ? std::size_t(pages) * std::size_t(size) : 4096 * mega;
}

}  // namespace dem
