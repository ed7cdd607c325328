#include "pipeline/best_form.h"

#include <fmt/format.h>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/mesh.h"
#include "pipeline/held_notices.h"
#include "pipeline/print_prediction.h"

namespace aerate {
namespace {

// More than this share of what was packed is left out: another form may remove more.
constexpr double kMuchLeftOut = 0.2;

// One escape hole is worth this share of what is removed: each is to be plugged or seen.
constexpr double kWorthOfHole = 0.005;

HollowedForm carve_form(const HollowOptions& options, Monitor& monitor) {
  HollowedForm form{&options, carve_model(options, monitor), std::nullopt};
  form.print = predict_print(form.hollowed.model.mesh, form.hollowed.carved.solid, form.hollowed.packing,
                             options, monitor);
  return form;
}

double removed_volume(const HollowedForm& form) {
  return form.hollowed.model.inspection.filled_volume - signed_volume(form.hollowed.carved.solid.mesh);
}

// Whether the print is described, so that filament decides.
bool is_by_filament(const HollowedForm& form) {
  return form.print && form.print->described;
}

// The larger, the better: mm3 of filament saved, or removed.
double worth(const HollowedForm& form) {
  if (is_by_filament(form)) return form.print->filament_before_mm3 - form.print->filament_after_mm3;
  const auto& drainage = form.hollowed.drainage;
  const double holes = drainage ? static_cast<double>(drainage->plan.holes.size()) : 0;
  return removed_volume(form) * (1 - kWorthOfHole * holes);
}

bool leaves_out_much(const HollowedForm& form) {
  const auto& drainage = form.hollowed.drainage;
  if (!drainage) return false;
  const double left_out = drainage->dropped.volume;
  return left_out > kMuchLeftOut * (left_out + removed_volume(form));
}

bool may_be_done_otherwise(const Error& error) {
  return error.code() == ExitCode::nothing_to_remove || error.code() == ExitCode::failure;
}

std::string name_of(const HollowedForm& form) {
  return form.options->cells ? "cells" : "spheres";
}

std::string figures_of(const HollowedForm& form) {
  if (is_by_filament(form))
    return fmt::format("{:.2f} cm3 of filament", form.print->filament_after_mm3 / 1000);
  return fmt::format("{:.2f} cm3 removed", removed_volume(form) / 1000);
}

std::string choice_in_words(const HollowedForm& chosen, const HollowedForm& other) {
  return fmt::format("voids are {}, with {}; {} would be {} (--shape {})", name_of(chosen),
                     figures_of(chosen), name_of(other), figures_of(other), name_of(other));
}

}  // namespace

HollowedForm carve_best_form(std::span<const HollowOptions> forms, Monitor& monitor) {
  const HollowOptions& preferred = forms.front();
  if (forms.size() == 1) return carve_form(preferred, monitor);
  std::optional<HollowedForm> best;
  std::vector<std::string> notices;
  std::optional<Error> refusal;  // of the preferred form
  for (const HollowOptions& options : forms) {
    HeldNotices held(monitor);
    try {
      HollowedForm form = carve_form(options, held);
      const bool is_better = !best || worth(form) > worth(*best);
      const std::string choice = !best       ? ""
                                 : is_better ? choice_in_words(form, *best)
                                             : choice_in_words(*best, form);
      if (is_better) {
        best = std::move(form);
        notices = held.take();
      }
      if (!choice.empty()) notices.push_back(choice);
    } catch (const Error& error) {
      const bool is_preferred = &options == &preferred;
      if (error.code() == ExitCode::interrupted || (is_preferred && !may_be_done_otherwise(error))) throw;
      if (is_preferred) refusal = error;
    }
    if (best && !preferred.infill_is_known && !leaves_out_much(*best)) break;
  }
  if (!best) throw Error(*refusal);
  if (refusal)
    notices.push_back(fmt::format("voids are {}, since of {} {}", name_of(*best),
                                  preferred.cells ? "cells" : "spheres", refusal->what()));
  for (const std::string& notice : notices) monitor.notice(notice);
  return std::move(*best);
}

}  // namespace aerate
