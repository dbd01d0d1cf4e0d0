// River particles [belhadj2005, section 2.2].

#include <algorithm>
#include <optional>

#include "synthesis/growth.h"

namespace dem::synthesis {
using namespace numeric;
namespace {

constexpr std::uint64_t stream_rivers = 0x71d6e002;
constexpr double least_speed = 0.02;  // slower than that, a particle is static
constexpr double first_push = 1;      // off the crest, where there is no slope

enum class State { flowing, joined, left, still };

/// A cell of a path, and the particle's velocity when it came there.
struct Visit {
  Cell cell;
  Point velocity;
};

struct RiverParticle {
  Point position, velocity;
  State state = State::flowing;
  int joins = -1;
  std::vector<Visit> path{};       // when it has joined, the last cell belongs to that river
  std::vector<int> tributaries{};  // those that joined this one
};

/// All river particles of a map, and who was where.
class Rivers {
 public:
  Rivers(const Map& map, const Ground& ground, double friction)
      : map_(map),
        ground_(ground),
        friction_(friction),
        stride_(0.7 * std::min(map.dx, map.dy)),
        owner_(map.size) {}

  void add(const RidgeCell& source, bool left) {
    if (owner_(source.cell.col, source.cell.row)) return;
    RiverParticle p;
    p.position = map_.centre_of(source.cell);
    p.velocity = (left ? first_push : -first_push) * left_of(source.along);
    rivers_.push_back(p);
    take(int(rivers_.size()) - 1, source.cell);
  }

  /// Moves every flowing particle by a cell; false when none is flowing.
  bool advance() {
    bool any = false;
    for (int i = 0; i < int(rivers_.size()); ++i)
      if (rivers_[std::size_t(i)].state == State::flowing) advance(i), any = true;
    return any;
  }

  /// The rivers that leave the map, and those that join them.
  std::vector<River> kept() const {
    std::vector<int> number(rivers_.size(), -1);
    std::vector<River> kept;
    for (std::size_t i = 0; i < rivers_.size(); ++i)
      if (leaves(i)) number[i] = int(kept.size()), kept.emplace_back();
    for (std::size_t i = 0; i < rivers_.size(); ++i) {
      if (number[i] < 0) continue;
      River& river = kept[std::size_t(number[i])];
      for (const auto& visit : rivers_[i].path) river.path.push_back(visit.cell);
      if (rivers_[i].state == State::joined) river.joins = number[std::size_t(rivers_[i].joins)];
    }
    return kept;
  }

 private:
  /// Where a path was met: whose, and at which cell of it.
  struct Meeting {
    int river;
    std::size_t at;
  };

  int owner(Cell c) const { return map_.contains(c) ? owner_(c.col, c.row) - 1 : -1; }

  void take(int i, Cell c) {
    owner_(c.col, c.row) = i + 1;
    rivers_[std::size_t(i)].path.push_back({c, rivers_[std::size_t(i)].velocity});
  }

  bool leaves(std::size_t i) const {
    while (rivers_[i].state == State::joined) i = std::size_t(rivers_[i].joins);
    return rivers_[i].state == State::left;
  }

  void advance(int i) {
    RiverParticle& p = rivers_[std::size_t(i)];
    const Cell from = p.path.back().cell;
    Cell to = from;
    for (int strides = 0; to == from; ++strides) {
      if (!move(p) || strides == 64) {
        p.state = State::still;
        return;
      }
      to = map_.cell_at(p.position);
    }
    if (!map_.contains(to)) {
      p.state = State::left;
    } else if (const auto meeting = meet(from, to); !meeting) {
      take(i, to);
    } else if (meeting->river == i) {
      backtrack(i, meeting->at);  // a loop, which no river keeps
      if (rivers_[std::size_t(i)].path.back().cell != to) take(i, to);
    } else {
      join(i, *meeting);
    }
  }

  /// One stride under gravity and friction; false when the particle stands still.
  bool move(RiverParticle& p) const {
    const double speed = std::max(length(p.velocity), least_speed);
    p.velocity = (1 / (1 + friction_ * stride_)) *
                 (p.velocity + (stride_ / speed) * ground_.pull(p.position));
    const double now = length(p.velocity);
    if (now < least_speed) return false;
    p.position = p.position + (stride_ / now) * p.velocity;
    return true;
  }

  /// The path that a step enters, or passes through between two diagonal neighbours:
  ///     from  a
  ///      b    to
  std::optional<Meeting> meet(Cell from, Cell to) const {
    if (const int river = owner(to); river >= 0) return Meeting{river, find(river, to)};
    const Cell a{to.col, from.row}, b{from.col, to.row};
    if (a == from || b == from || owner(a) < 0 || owner(a) != owner(b)) return {};
    const std::size_t at_a = find(owner(a), a), at_b = find(owner(a), b);
    if (std::max(at_a, at_b) - std::min(at_a, at_b) != 1) return {};
    return Meeting{owner(a), std::min(at_a, at_b)};
  }

  std::size_t find(int river, Cell c) const {
    const auto& path = rivers_[std::size_t(river)].path;
    std::size_t at = path.size() - 1;
    while (path[at].cell != c) --at;
    return at;
  }

  /// The particle i stops on the path of another, which goes on from there with the velocities of
  /// both. (Masses are summed up in the end.)
  void join(int i, Meeting meeting) {
    backtrack(meeting.river, meeting.at);
    RiverParticle& p = rivers_[std::size_t(i)];
    RiverParticle& other = rivers_[std::size_t(meeting.river)];
    const Visit there = other.path.back();
    p.path.push_back({there.cell, p.velocity});
    p.state = State::joined;
    p.joins = meeting.river;
    other.tributaries.push_back(i);
    other.position = map_.centre_of(there.cell);
    other.velocity = there.velocity + p.velocity;
  }

  /// Takes back the path of a river after its cell `at`. Rivers that joined it there flow on.
  void backtrack(int i, std::size_t at) {
    RiverParticle& p = rivers_[std::size_t(i)];
    if (p.state == State::joined) leave(i);
    p.state = State::flowing;
    std::vector<int> freed;
    for (int t : p.tributaries)
      if (find(i, rivers_[std::size_t(t)].path.back().cell) > at) freed.push_back(t);
    for (int t : freed) leave(t);
    for (std::size_t n = at + 1; n < p.path.size(); ++n)
      owner_(p.path[n].cell.col, p.path[n].cell.row) = 0;
    p.path.resize(at + 1);
  }

  /// Parts a river from the one that it has joined, to flow again from its own last cell.
  void leave(int i) {
    RiverParticle& p = rivers_[std::size_t(i)];
    RiverParticle& other = rivers_[std::size_t(p.joins)];
    std::erase(other.tributaries, i);
    p.path.pop_back();
    p.state = State::flowing;
    p.joins = -1;
    p.position = map_.centre_of(p.path.back().cell);
    p.velocity = p.path.back().velocity;
  }

  const Map& map_;
  const Ground& ground_;
  double friction_, stride_;
  Raster<std::int32_t> owner_;  // the number of the river + 1
  std::vector<RiverParticle> rivers_;
};

}  // namespace

std::vector<River> grow_rivers(const Map& map, const Ground& ground,
                               const std::vector<RidgeCell>& ridges, const NetworkOptions& o,
                               const Run& run) {
  Rivers rivers(map, ground, o.friction);
  Sequence random(o.seed, stream_rivers);
  for (int i = 0; i < o.springs && !ridges.empty(); ++i) {
    const RidgeCell& source = ridges[random.below(ridges.size())];
    rivers.add(source, random.below(2) == 0);
  }
  // Rivers whose confluences wash each other away are given up after that many rounds.
  const int rounds = 16 * (map.size.cols + map.size.rows);
  for (int round = 0; round < rounds && rivers.advance(); ++round)
    if (round % 256 == 0) run.report(double(round) / rounds, "rivers");
  return rivers.kept();
}

}  // namespace dem::synthesis
