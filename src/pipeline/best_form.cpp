#include "pipeline/best_form.h"

#include <array>
#include <fmt/format.h>
#include <limits>
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

// Of the radius from which voids pay: where lines are wide and walls thin, such small ones do too (docs/economics.md).
constexpr std::array kPayingShares{1.0, 0.7, 0.5, 0.35};

// Where voids make a print heavier by more than this share, smaller ones do so more.
constexpr double kMuchHeavier = 0.03;

HollowedForm carve_with(double paying_share, const HollowOptions& options, Monitor& monitor) {
  HollowOptions shared = options;
  shared.paying_share = paying_share;
  HollowedForm form{&options, carve_model(shared, monitor), std::nullopt};
  form.print = predict_print(form.hollowed.model.mesh, form.hollowed.carved.solid, form.hollowed.packing,
                             options, monitor);
  return form;
}

// Whether voids are left out that would cost more filament than they save by themselves.
bool leaves_out_by_radius(const HollowOptions& options) {
  return options.infill_is_known && options.heavier == HeavierPrint::refuse && !options.modifiers &&
         !options.cells && options.packing.spheres.empty();
}

// With the voids from the radius on that pays as a rule or, where the print does not become lighter by these, by smaller
// ones: they may share walls and skins. What the whole print takes decides.
HollowedForm carve_what_pays(const HollowOptions& options, Monitor& monitor) {
  std::optional<HollowedForm> lightest;
  double least = std::numeric_limits<double>::infinity();  // of filament, mm3
  std::vector<std::string> notices;
  std::optional<NothingToRemoveError> refusal;
  for (const double share : kPayingShares) {
    HeldNotices held(monitor);
    try {
      HollowedForm form = carve_with(share, options, held);
      const PrintPrediction print = form.print.value();
      if (print.filament_after_mm3 < least) {
        least = print.filament_after_mm3;
        lightest = std::move(form);
        notices = held.take();
      }
      if (!print.heavier() || print.usual.share() > kMuchHeavier) break;
    } catch (const NothingToRemoveError& error) {
      if (!refusal) refusal = error;
    }
  }
  if (!lightest) throw NothingToRemoveError(*refusal);
  HeldNotices verdict(monitor);
  judge(lightest->print.value(), options, verdict);
  for (const std::string& notice : notices) monitor.notice(notice);
  verdict.pass_on();
  return std::move(*lightest);
}

HollowedForm carve_form(const HollowOptions& options, Monitor& monitor) {
  if (leaves_out_by_radius(options)) return carve_what_pays(options, monitor);
  HollowedForm form = carve_with(1, options, monitor);
  if (form.print) judge(*form.print, options, monitor);
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

std::size_t count_groups(const HollowedForm& form) {
  const auto& drainage = form.hollowed.drainage;
  return drainage ? drainage->plan.network_count : 1;
}

double cell_size(const HollowOptions& options) {
  const PackingLimits limits = options.packing.limits();
  return 2 * limits.max_radius + limits.gap;
}

// Whether another form may be better than the best so far.
bool is_worth_trying(const HollowOptions& other, const HollowedForm& best) {
  if (best.options->infill_is_known || leaves_out_much(best)) return true;
  if (other.cells.has_value() != best.options->cells.has_value()) return false;
  // Each group of voids takes two holes; there are fewer groups of larger cells.
  const bool are_larger = other.packing.limits().max_radius > best.options->packing.limits().max_radius;
  return !are_larger || count_groups(best) > 1;
}

std::string name_of(const HollowedForm& form) {
  if (!form.options->cells) return "spheres";
  return fmt::format("cells of {:g} mm", cell_size(*form.options));
}

std::string option_of(const HollowOptions& options) {
  if (!options.cells) return "--shape spheres";
  return fmt::format("--shape cells --cell-size {:g}", cell_size(options));
}

std::string figures_of(const HollowedForm& form) {
  if (is_by_filament(form))
    return fmt::format("{:.2f} cm3 of filament", form.print->filament_after_mm3 / 1000);
  std::string figures = fmt::format("{:.2f} cm3 removed", removed_volume(form) / 1000);
  if (const auto& drainage = form.hollowed.drainage)
    figures += fmt::format(" and {} escape holes", drainage->plan.holes.size());
  return figures;
}

// Whether a user might want what was not chosen.
bool is_of_interest(const HollowedForm& other, const HollowedForm& chosen) {
  if (is_by_filament(chosen) || !chosen.hollowed.drainage || !other.hollowed.drainage) return true;
  return removed_volume(other) > removed_volume(chosen) ||
         other.hollowed.drainage->plan.holes.size() < chosen.hollowed.drainage->plan.holes.size();
}

std::string choice_in_words(const HollowedForm& chosen, const HollowedForm& other) {
  return fmt::format("voids are {}, with {}; {} would be {} ({})", name_of(chosen), figures_of(chosen),
                     name_of(other), figures_of(other), option_of(*other.options));
}

}  // namespace

HollowedForm carve_best_form(std::span<const HollowOptions> forms, Monitor& monitor) {
  const HollowOptions& preferred = forms.front();
  if (forms.size() == 1) return carve_form(preferred, monitor);
  std::optional<HollowedForm> best;
  std::vector<std::string> notices;
  std::optional<Error> refusal;  // of the preferred form
  for (const HollowOptions& options : forms) {
    if (best && !is_worth_trying(options, *best)) continue;
    HeldNotices held(monitor);
    try {
      HollowedForm form = carve_form(options, held);
      const bool is_better = !best || worth(form) > worth(*best);
      std::string choice;
      if (best && is_better)
        choice = choice_in_words(form, *best);
      else if (best && is_of_interest(form, *best))
        choice = choice_in_words(*best, form);
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
  }
  if (!best) throw Error(*refusal);
  if (refusal)
    notices.push_back(
        fmt::format("voids are {}, since with {} {}", name_of(*best), option_of(preferred), refusal->what()));
  for (const std::string& notice : notices) monitor.notice(notice);
  return std::move(*best);
}

}  // namespace aerate
