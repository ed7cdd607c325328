#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace aerate::batch {

enum class Outcome {
  done,
  refused,  // the job says that it cannot be done: exit status 2 to 5
  failed,   // exit status 1, as for an output that cannot be written
  crashed,  // a signal ended its process
  not_done  // the batch was stopped before
};
const char* name_of(Outcome outcome);

// Those of a job's report that the summary has; nothing where they do not apply.
struct Figures {
  std::optional<double> triangles_before, triangles_after, voids;
  std::optional<double> volume_before_mm3, removed_mm3, removed_percent;
  std::optional<double> mass_before_g, mass_after_g, cost_before, cost_after;
  std::optional<double> filament_change_percent;
};

struct FigureRow {
  const char* name;       // in the summary and in records
  const char* in_report;  // JSON pointer there
  std::optional<double> Figures::*figure;
  bool is_summed;  // has a total
};

inline constexpr std::array kFigureRows{
    FigureRow{"triangles_before", "/input/triangles", &Figures::triangles_before, true},
    FigureRow{"triangles_after", "/output/triangles", &Figures::triangles_after, true},
    FigureRow{"voids", "/voids/count", &Figures::voids, true},
    FigureRow{"volume_before_mm3", "/volume/before_mm3", &Figures::volume_before_mm3, true},
    FigureRow{"removed_mm3", "/volume/removed_mm3", &Figures::removed_mm3, true},
    FigureRow{"removed_percent", "/volume/removed_percent", &Figures::removed_percent, false},
    FigureRow{"mass_before_g", "/material/mass_before_g", &Figures::mass_before_g, true},
    FigureRow{"mass_after_g", "/material/mass_after_g", &Figures::mass_after_g, true},
    FigureRow{"cost_before", "/material/cost_before", &Figures::cost_before, true},
    FigureRow{"cost_after", "/material/cost_after", &Figures::cost_after, true},
    FigureRow{"filament_change_percent", "/print/filament_change_percent", &Figures::filament_change_percent,
              false}};

// How a job ended.
struct JobRecord {
  Outcome outcome = Outcome::not_done;
  int exit_code = 0;         // 128 + signal of a crash
  std::string message = {};  // of what was not done
  Figures figures = {};
  double seconds = 0;         // from the start of its process to its end
  double seconds_in_job = 0;  // of them in stages, as its report has it; 0 without one
  double peak_memory_bytes = 0;
  std::map<std::string, std::uintmax_t> bytes_of_files = {};  // by their names beside the record
};

}  // namespace aerate::batch
