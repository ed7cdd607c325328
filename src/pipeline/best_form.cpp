#include "pipeline/best_form.h"

#include <array>
#include <cmath>
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

// What differs by less is the same.
constexpr double kSmallDifference = 1e-3;

// Of the model's volume; so much less is removed under limits that allow more, if that saves holes.
constexpr double kAgainstFreedom = 0.003;

constexpr std::size_t kHolesOfGroup = 2;

// Of the radius from which voids pay: where lines are wide and walls thin, such small ones do too (docs/economics.md).
constexpr std::array kPayingShares{1.0, 0.7, 0.5, 0.35};

// Where voids make a print heavier by more than this share, smaller ones do so more.
constexpr double kMuchHeavier = 0.03;

HollowedForm carve_with(double paying_share, const HollowOptions& options, PreparedModels& models,
                        Monitor& monitor) {
  HollowOptions shared = options;
  shared.paying_share = paying_share;
  HollowedForm form{&options, carve_model(shared, models, monitor), std::nullopt};
  form.print = predict_print(form.hollowed.model->mesh, form.hollowed.carved.solid, form.hollowed.packing,
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
HollowedForm carve_what_pays(const HollowOptions& options, PreparedModels& models, Monitor& monitor) {
  std::optional<HollowedForm> lightest;
  double least = std::numeric_limits<double>::infinity();  // of filament, mm3
  std::vector<std::string> notices;
  std::optional<NothingToRemoveError> refusal;
  for (const double share : kPayingShares) {
    HeldNotices held(monitor);
    try {
      HollowedForm form = carve_with(share, options, models, held);
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

HollowedForm carve_form(const HollowOptions& options, PreparedModels& models, Monitor& monitor) {
  if (leaves_out_by_radius(options)) return carve_what_pays(options, models, monitor);
  HollowedForm form = carve_with(1, options, models, monitor);
  if (form.print) judge(*form.print, options, monitor);
  return form;
}

double removed_volume(const HollowedForm& form) {
  return form.hollowed.model->inspection.filled_volume - signed_volume(form.hollowed.carved.solid.mesh);
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

bool is_more(double one, double other) {
  return one > other + kSmallDifference * std::abs(other);
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

// Whether larger cells may do with fewer holes: each group of voids takes two, those beyond are for pools.
bool has_many_holes(const HollowedForm& form) {
  const auto& drainage = form.hollowed.drainage;
  if (!drainage) return false;
  const DrainagePlan& plan = drainage->plan;
  return plan.network_count > 1 || plan.holes.size() > kHolesOfGroup * plan.network_count;
}

// Whether there is one cell for each region of the model.
bool is_single(const HollowOptions& options) {
  return options.cells && options.packing.stop.max_count == 1;
}

double cell_size(const HollowOptions& options) {
  const PackingLimits limits = options.packing.limits();
  return 2 * limits.max_radius + limits.gap;
}

// The best so far, and what the next form is judged by.
struct Search {
  std::optional<HollowedForm> best;
  std::vector<std::string> notices;  // of the best, and of what it was compared with
  std::optional<Error> refusal;      // of the preferred form
  int limits = 0, limits_of_best = 0;
  // Of the best of the forms that differ in the size of cells alone, as far as they were made.
  bool takes_many_holes = false;
  double worth_of_size = 0;

  bool is_worth_trying(const JobForm& form) const {
    if (!best) return true;
    if (form.tried == FormTrial::otherwise) return false;
    if (best->options->infill_is_known || leaves_out_much(*best)) return true;
    return form.tried == FormTrial::always || (form.tried == FormTrial::for_fewer_holes && takes_many_holes);
  }

  void note_size(const HollowedForm& form, FormTrial tried) {
    const double its_worth = worth(form);
    if (tried == FormTrial::for_fewer_holes && !is_more(its_worth, worth_of_size)) return;
    takes_many_holes = has_many_holes(form);
    worth_of_size = its_worth;
  }

  // Limits that allow more are no reason to remove less.
  bool is_better(const HollowedForm& form) const {
    if (!best) return true;
    const double gained = removed_volume(form) - removed_volume(*best);
    const double whole = form.hollowed.model->inspection.filled_volume;
    if (!is_by_filament(form) && limits != limits_of_best && std::abs(gained) > kAgainstFreedom * whole)
      return gained > 0;
    return is_more(worth(form), worth(*best));
  }
};

std::string name_of(const HollowedForm& form) {
  if (!form.options->cells) return "spheres";
  if (is_single(*form.options)) return "one cell for each region";
  return fmt::format("cells of {:g} mm", cell_size(*form.options));
}

std::string option_of(const HollowOptions& options) {
  if (!options.cells) return "--shape spheres";
  if (is_single(options)) return "--shape cells --max-voids 1";
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
  return is_more(removed_volume(other), removed_volume(chosen)) ||
         other.hollowed.drainage->plan.holes.size() < chosen.hollowed.drainage->plan.holes.size();
}

std::string choice_in_words(const HollowedForm& chosen, const HollowedForm& other) {
  return fmt::format("voids are {}, with {}; {} would be {} ({})", name_of(chosen), figures_of(chosen),
                     name_of(other), figures_of(other), option_of(*other.options));
}

void try_form(const JobForm& job, bool is_preferred, PreparedModels& models, Search& search,
              Monitor& monitor) {
  if (job.tried == FormTrial::always) ++search.limits;
  if (!search.is_worth_trying(job)) {
    if (job.tried == FormTrial::for_more_volume) search.takes_many_holes = false;
    return;
  }
  HeldNotices held(monitor);
  try {
    HollowedForm form = carve_form(job.options, models, held);
    search.note_size(form, job.tried);
    const bool is_better = search.is_better(form);
    std::string choice;
    if (search.best && is_better)
      choice = choice_in_words(form, *search.best);
    else if (search.best && is_of_interest(form, *search.best))
      choice = choice_in_words(*search.best, form);
    if (is_better) {
      search.best = std::move(form);
      search.limits_of_best = search.limits;
      search.notices = held.take();
    }
    if (!choice.empty()) search.notices.push_back(choice);
  } catch (const Error& error) {
    if (error.code() == ExitCode::interrupted || (is_preferred && !may_be_done_otherwise(error))) throw;
    if (is_preferred) search.refusal = error;
  }
}

}  // namespace

HollowedForm carve_best_form(std::span<const JobForm> forms, PreparedModels& models, Monitor& monitor) {
  const HollowOptions& preferred = forms.front().options;
  if (forms.size() == 1) return carve_form(preferred, models, monitor);
  Search search;
  for (const JobForm& form : forms) try_form(form, &form == &forms.front(), models, search, monitor);
  if (!search.best) throw Error(*search.refusal);
  if (search.refusal)
    search.notices.push_back(fmt::format("voids are {}, since with {} {}", name_of(*search.best),
                                         option_of(preferred), search.refusal->what()));
  for (const std::string& notice : search.notices) monitor.notice(notice);
  return std::move(*search.best);
}

}  // namespace aerate
