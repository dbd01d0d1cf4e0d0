#pragma once
// Filled holes on disk, until the raster is written: cut by strips of rows, so that writing needs
// one strip at a time, and closed window by window, so that a run can go on after any stop.

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "dem/fill.h"
#include "dem/io/fill_job.h"

namespace dem::io {

/// Cells of some holes in one strip of rows.
struct StripPiece {
  std::vector<CellRun> runs;
  std::vector<float> z, sigma;  // sigma may be empty
  std::vector<CellOrigin> origin;
};

/// Puts the pieces' cells of one layer into `rows`, the cells of `box` of the raster.
void overlay(const std::vector<StripPiece>& pieces, FillLayer layer, const Box& box, Dem& rows);

class Journal : public FillStore {
 public:
  static constexpr int strip_rows = 256;
  enum class Access { write, read };

  /// Opens the file at `path`. What is in it is kept when it was begun with the same `key` (input,
  /// method, options ...) and is whole up to some point; the rest is cut off.
  /// To read, it must be there and have the key.
  /// Throws IoError.
  Journal(const std::string& path, const std::string& key, Access access = Access::write);

  bool has(std::size_t window) const override { return window < done_.size() && done_[window]; }
  const std::vector<HolePatch>& done() const override { return entries_; }
  void add(const HolePatch& patch) override;

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

/// The journal of a run and those that tasks have left: it adds to the first.
class Journals : public FillStore {
 public:
  void open(const std::string& path, const std::string& key, Journal::Access access);

  bool has(std::size_t window) const override;
  const std::vector<HolePatch>& done() const override { return done_; }
  void add(const HolePatch& patch) override { journals_.front()->add(patch); }

  /// All pieces of one strip, those of every journal.
  std::vector<StripPiece> strip(int number);

  /// Closes the files.
  void close() { journals_.clear(); }

 private:
  std::vector<std::unique_ptr<Journal>> journals_;
  std::vector<HolePatch> done_;
};

}  // namespace dem::io
