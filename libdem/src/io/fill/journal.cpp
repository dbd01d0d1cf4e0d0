#include "io/fill/journal.h"

#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <iterator>
#include <map>
#include <span>

#include "dem/io/rasters.h"
#include "io/fill/bytes.h"

namespace dem::io {
namespace {

// A record: head, then `bytes` bytes. Kinds: the key of the run, a piece of a strip, a window that
// is done with all its pieces.
struct Head {
  std::uint32_t kind, number;
  std::uint64_t bytes, checksum;
};
enum Kind : std::uint32_t { kKey = 0x4b455931, kPiece = 0x50494531, kDone = 0x444f4e31 };

std::uint64_t checksum(std::string_view bytes, std::uint64_t start) {
  std::uint64_t sum = start ^ 0xcbf29ce484222325ULL;
  std::size_t i = 0;
  for (; i + 8 <= bytes.size(); i += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data() + i, 8);
    sum = (sum ^ word) * 0x9e3779b97f4a7c15ULL;
    sum ^= sum >> 29;
  }
  for (; i < bytes.size(); ++i)
    sum = (sum ^ static_cast<unsigned char>(bytes[i])) * 0x100000001b3ULL;
  return sum;
}

std::string bytes_of(const StripPiece& piece) {
  std::string out;
  put(out, piece.runs);
  put(out, piece.z);
  put(out, piece.sigma);
  put(out, piece.origin);
  return out;
}

StripPiece piece_of(std::string_view bytes) {
  StripPiece piece;
  Taker taker(bytes);
  taker.take(piece.runs);
  taker.take(piece.z);
  taker.take(piece.sigma);
  taker.take(piece.origin);
  return piece;
}

/// A patch without its cells, but with how many of each origin each hole has.
std::string bytes_of(const HolePatch& patch) {
  std::string out;
  put(out, patch.holes);
  put(out, patch.guide);
  put(out, patch.rim_error_m);
  put(out, patch.offset_m);
  put(out, patch.cells_by_origin);
  put(out, std::vector<double>{patch.seconds, patch.contour_lines ? 1. : 0.});
  return out;
}

HolePatch patch_of(std::string_view bytes, std::size_t window) {
  HolePatch patch;
  patch.window = window;
  std::vector<double> more;
  Taker taker(bytes);
  taker.take(patch.holes);
  taker.take(patch.guide);
  taker.take(patch.rim_error_m);
  taker.take(patch.offset_m);
  taker.take(patch.cells_by_origin);
  taker.take(more);
  patch.seconds = more.at(0);
  patch.contour_lines = more.at(1) != 0;
  return patch;
}

}  // namespace

Journal::Journal(const std::string& path, const std::string& key, Access access)
    : path_(path), file_(std::fopen(path.c_str(), access == Access::read ? "rb" : "a+b")) {
  if (!file_) fail();
  if (flock(fileno(file_.get()), (access == Access::read ? LOCK_SH : LOCK_EX) | LOCK_NB) != 0)
    throw IoError(path, "journal: another run is working with it");
  load(key, access);
}

void Journal::fail() const {
  throw IoError(path_, std::string("journal: ") + std::strerror(errno));
}

void Journal::load(const std::string& key, Access access) {
  std::FILE* const file = file_.get();
  std::fseek(file, 0, SEEK_END);
  const long size = std::ftell(file);
  long whole = 0;  // up to here everything belongs to windows that are done
  std::vector<std::pair<std::uint32_t, Place>> pieces;
  std::string bytes;
  std::fseek(file, 0, SEEK_SET);
  for (long at = 0;;) {
    Head head{};
    if (std::fread(&head, sizeof head, 1, file) != 1) break;
    at += long(sizeof head);
    if (head.bytes > std::uint64_t(size - at)) break;
    bytes.resize(head.bytes);
    if (head.bytes > 0 && std::fread(bytes.data(), head.bytes, 1, file) != 1) break;
    if (checksum(bytes, head.kind + head.number) != head.checksum) break;
    if ((at == long(sizeof head)) != (head.kind == kKey)) break;
    if (head.kind == kKey && bytes != key) break;
    if (head.kind == kPiece) pieces.push_back({head.number, {at, std::size_t(head.bytes)}});
    at += long(head.bytes);
    if (head.kind == kPiece) continue;
    if (head.kind == kDone) {
      for (const auto& [strip, place] : pieces) index_piece(strip, place);
      pieces.clear();
      close_window(patch_of(bytes, head.number));
    }
    whole = at;
  }
  if (access == Access::read) {
    if (whole == 0)
      throw IoError(path_, "journal: is that of another input or other settings; remove it");
    return;
  }
  if (ftruncate(fileno(file), whole) != 0) fail();
  std::fseek(file, 0, SEEK_END);
  if (whole == 0) append(kKey, 0, key);
  if (std::fflush(file) != 0) fail();
}

void Journal::append(std::uint32_t kind, std::uint32_t number, const std::string& bytes) {
  const Head head{kind, number, bytes.size(), checksum(bytes, kind + number)};
  std::FILE* const file = file_.get();
  if (std::fwrite(&head, sizeof head, 1, file) != 1 ||
      std::fwrite(bytes.data(), 1, bytes.size(), file) != bytes.size())
    fail();
}

void Journal::index_piece(std::uint32_t strip, Place place) {
  if (strips_.size() <= strip) strips_.resize(std::size_t(strip) + 1);
  strips_[strip].push_back(place);
}

void Journal::close_window(HolePatch&& patch) {
  if (done_.size() <= patch.window) done_.resize(patch.window + 1);
  done_[patch.window] = true;
  entries_.push_back(std::move(patch));
}

void Journal::add(const HolePatch& patch) {
  std::map<std::uint32_t, StripPiece> pieces;
  std::size_t cell = 0;
  for (const CellRun& run : patch.runs) {
    StripPiece& piece = pieces[std::uint32_t(run.row / strip_rows)];
    const auto n = std::size_t(run.end - run.begin);
    const auto copy = [&](const auto& from, auto& to) {
      const auto begin = from.begin() + std::ptrdiff_t(cell);
      to.insert(to.end(), begin, begin + std::ptrdiff_t(n));
    };
    piece.runs.push_back(run);
    copy(patch.z, piece.z);
    copy(patch.origin, piece.origin);
    if (!patch.sigma.empty()) copy(patch.sigma, piece.sigma);
    cell += n;
  }
  errno = 0;
  std::fseek(file_.get(), 0, SEEK_END);
  for (const auto& [strip, piece] : pieces) {
    const std::string bytes = bytes_of(piece);
    const long offset = std::ftell(file_.get()) + long(sizeof(Head));
    append(kPiece, strip, bytes);
    index_piece(strip, {offset, bytes.size()});
  }
  const std::string bytes = bytes_of(patch);
  append(kDone, std::uint32_t(patch.window), bytes);
  if (std::fflush(file_.get()) != 0) fail();
  close_window(patch_of(bytes, patch.window));
}

std::vector<StripPiece> Journal::strip(int number) {
  std::vector<StripPiece> pieces;
  if (std::size_t(number) >= strips_.size()) return pieces;
  std::string bytes;
  for (const Place& place : strips_[std::size_t(number)]) {
    bytes.resize(place.bytes);
    std::fseek(file_.get(), place.offset, SEEK_SET);
    if (std::fread(bytes.data(), 1, bytes.size(), file_.get()) != bytes.size()) fail();
    pieces.push_back(piece_of(bytes));
  }
  return pieces;
}

void Journals::open(const std::string& path, const std::string& key, Journal::Access access) {
  journals_.push_back(std::make_unique<Journal>(path, key, access));
  const auto& more = journals_.back()->done();
  done_.insert(done_.end(), more.begin(), more.end());
}

bool Journals::has(std::size_t window) const {
  return std::ranges::any_of(journals_, [&](const auto& journal) { return journal->has(window); });
}

std::vector<StripPiece> Journals::strip(int number) {
  std::vector<StripPiece> pieces;
  for (const auto& journal : journals_)
    std::ranges::move(journal->strip(number), std::back_inserter(pieces));
  return pieces;
}

void overlay(const std::vector<StripPiece>& pieces, FillLayer layer, const Box& box, Dem& rows) {
  for (const StripPiece& piece : pieces) {
    std::size_t cell = 0;
    for (const CellRun& run : piece.runs) {
      const std::size_t first = cell;
      cell += std::size_t(run.end - run.begin);
      if (run.row < box.row || run.row >= box.row + box.rows) continue;
      const int end = std::min(run.end, box.col + box.cols);
      for (int col = std::max(run.begin, box.col); col < end; ++col) {
        const std::size_t i = first + std::size_t(col - run.begin);
        float& z = rows.z(col - box.col, run.row - box.row);
        if (layer == FillLayer::origin) z = float(piece.origin[i]);
        if (piece.origin[i] == CellOrigin::left) continue;
        if (layer == FillLayer::heights) z = piece.z[i];
        if (layer == FillLayer::sigma && !piece.sigma.empty()) z = piece.sigma[i];
        rows.known(col - box.col, run.row - box.row) = 1;
      }
    }
  }
}

}  // namespace dem::io
