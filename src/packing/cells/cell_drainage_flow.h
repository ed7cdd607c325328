#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace aerate {

// The most that can flow from sources to sinks along edges without limit (E. Dinic's method, 1970). Vertices
// are 0 .. count - 1; each may have a supply and a demand.
class FreeFlow {
 public:
  explicit FreeFlow(std::size_t count);
  void supply(std::uint32_t vertex, double amount);
  void demand(std::uint32_t vertex, double amount);
  void connect(std::uint32_t from, std::uint32_t to);
  double most();

 private:
  struct Edge {
    std::uint32_t to;
    double room;
  };
  void add(std::uint32_t from, std::uint32_t to, double room);
  bool level();
  double push();

  std::uint32_t source_, sink_;
  std::vector<Edge> edges_;                        // each followed by the way back
  std::vector<std::vector<std::uint32_t>> leave_;  // by vertex
  std::vector<std::uint32_t> level_;
  std::vector<std::size_t> next_;
};

}  // namespace aerate
