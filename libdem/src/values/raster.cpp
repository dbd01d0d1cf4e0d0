#include "dem/raster.h"

#include <sys/mman.h>

#include <cstdlib>

namespace dem {

void* allocate_cells(std::size_t bytes) {
  constexpr std::size_t line = 64, large_page = std::size_t{2} << 20;
  const bool large = bytes >= large_page;
  void* cells = nullptr;
  if (posix_memalign(&cells, large ? large_page : line, bytes) != 0) throw std::bad_alloc();
#ifdef MADV_HUGEPAGE
  // Whole large pages only, so that the block takes no more memory than it needs. This is a wish:
  // a system that has none left goes on with small ones.
  if (large) madvise(cells, bytes / large_page * large_page, MADV_HUGEPAGE);
#endif
  return cells;
}

void free_cells(void* cells) noexcept { std::free(cells); }

}  // namespace dem
