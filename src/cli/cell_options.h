#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "pipeline/options.h"

namespace aerate::cli {

// What the options of cells say that depends on the command.
struct CellWords {
  std::string shape;      // what is made of a packing, and what it is by default
  std::string fillet;     // the default of --fillet
  std::string tolerance;  // whose the tolerance is, and its default
};

// A packing request with what is made of it.
struct ShapedRequest {
  PackingRequest packing;
  std::optional<CellOptions> cells;  // absent: spheres
  std::optional<double> tolerance;   // as given, or the default of cells, mm
};

// Whether a packing leaves it open to make cells of it.
bool may_be_cells(const PackingRequest& request);

// --shape, --cell-size, --fillet, --tolerance, for every command that makes cells.
class CellCommandOptions {
 public:
  CellCommandOptions(CLI::App& command, const CellWords& words);

  // Whether --shape says cells; nothing where it is not given.
  std::optional<bool> asks_for_cells() const;
  // Whether --cell-size or --fillet is given.
  bool says_how_cells_are() const { return cell_size_ || fillet_; }
  // Throws UsageError for --fillet and --tolerance, of which `why` says why they have no effect.
  void require_neither_fillet_nor_tolerance(const std::string& where, const std::string& why) const;
  // The request for cells or for spheres. Throws UsageError for options of cells that spheres do not have, and for
  // those that contradict each other.
  //   fillet: unless it is given, mm
  ShapedRequest applied_to(PackingRequest packing, bool makes_cells, double fillet) const;

 private:
  std::string shape_;
  std::optional<double> cell_size_;  // mm
  std::optional<double> fillet_;     // mm
  std::optional<double> tolerance_;  // mm
};

}  // namespace aerate::cli
