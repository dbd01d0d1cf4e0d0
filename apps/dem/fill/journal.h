#pragma once
// Filled holes on disk, until the raster is written: cut by strips of rows, so that writing needs
// one strip at a time, and closed window by window, so that a run can go on after any stop.

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "dem/holes.h"

namespace dem::app {

/// Cells of some holes in one strip of rows.
struct StripPiece {
  std::vector<CellRun> runs;
  std::vector<float> z, sigma;  // sigma may be empty
  std::vector<CellOrigin> origin;
};

enum class Layer { heights, sigma, origin };

/// Puts the pieces' cells of one layer into `rows`, the cells of `box` of the raster.
void overlay(const std::vector<StripPiece>& pieces, Layer layer, const Box& box, Dem& rows);

class Journal {
 public:
  static constexpr int strip_rows = 256;
  enum class Access { write, read };

  /// Opens the file at `path`. What is in it is kept when it was begun with the same `key` (input,
  /// method, options ...) and is whole up to some point; the rest is cut off.
  /// To read, it must be there and have the key.
  /// Throws IoError.
  Journal(const std::string& path, const std::string& key, Access access = Access::write);

  /// Whether a window is in it.
  bool has(std::size_t window) const { return window < done_.size() && done_[window]; }
  std::size_t windows() const { return entries_.size(); }

  /// The outcomes of the windows that were in the file when it was opened, without cells.
  const std::vector<HolePatch>& entries() const { return entries_; }

  /// Adds a window; it is on the file when the call returns.
  void add(const HolePatch& patch);

  /// All pieces of one strip.
  std::vector<StripPiece> strip(int number);

 private:
  struct Place {
    long offset;
    std::size_t bytes;
  };
  struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  void load(const std::string& key, Access access);
  void append(std::uint32_t kind, std::uint32_t number, const std::string& bytes);
  void index_piece(std::uint32_t strip, Place place);
  void close_window(HolePatch&& patch);
  [[noreturn]] void fail() const;

  std::string path_;
  std::unique_ptr<std::FILE, CloseFile> file_;
  std::vector<std::vector<Place>> strips_;
  std::vector<bool> done_;
  std::vector<HolePatch> entries_;
};

}  // namespace dem::app
