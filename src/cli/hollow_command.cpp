#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/ranges.h>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "cli/called_commands.h"
#include "cli/cell_options.h"
#include "cli/command_alone.h"
#include "cli/commands.h"
#include "cli/drainage_options.h"
#include "cli/hollow_forms.h"
#include "cli/keep_solid_options.h"
#include "cli/model_options.h"
#include "cli/numbers.h"
#include "cli/print_options.h"
#include "cli/run_reported.h"
#include "cli/view_options.h"
#include "cli/void_options.h"
#include "core/error.h"
#include "core/listed.h"
#include "files/formats.h"
#include "files/weld.h"
#include "packing/methods.h"
#include "pipeline/hollow.h"
#include "pipeline/lightning_modifiers.h"
#include "pipeline/solid_file.h"
#include "printing/materials.h"
#include "printing/slicers/slicers.h"

namespace aerate::cli {
namespace {

// As the command line and its help name a slicer's modifiers.
std::vector<std::string> flavor_of(const SlicerProfile& slicer) {
  return slicer.modifiers ? std::vector{slicer.modifiers->flavor} : std::vector<std::string>{};
}

std::vector<std::string> described_flavor(const SlicerProfile& slicer) {
  if (!slicer.modifiers) return {};
  return {fmt::format("{} ({}{})", slicer.modifiers->flavor, fmt::join(slicer.family, ", "),
                      slicer.untested ? "; untested" : "")};
}

std::string packings_on_a_lattice() {
  std::vector<std::string> names;
  for (const PackingMethod& method : packing_methods())
    if (method.on_lattice) names.emplace_back(method.name);
  return listed(names, "or");
}

// Whether voids are cells, if that was not said.
bool makes_cells(const Process& process) {
  return process.drainage == Drainage::needed && !process.limits.contains(Limit::bridge);
}

// Round inner edges of voids that drain leave room for what runs along them; below roofs their faces are small, and
// windows need what is flat of these. Millimetres.
double default_fillet(const HollowOptions& options) {
  if (!options.drainage) return CellOptions{}.fillet;
  const bool has_roofs = options.packing.limits().roof.limits_ceilings();
  return has_roofs ? options.drainage->channel_radius / 2 : options.drainage->channel_radius;
}

CellWords words_of_void_cells() {
  return {
      .shape =
          "What voids are: the packed spheres, or the cells round them, which meet in plane walls as "
          "thick as --gap and take nearly all that is deeper than --wall (default cells for modifiers, and "
          "where voids drain and ceilings are not limited, which is " +
          processes_that(makes_cells) + "; unless there is --packing " + packings_on_a_lattice() +
          ", --spheres or --target-density; else spheres. With --infill both are tried and the one that "
          "takes less "
          "filament is made; the other is, too, where voids cannot be drained)",
      .fillet = "the channels' radius, half of it where ceilings are limited, else 1",
      .tolerance = "Void surfaces stay this far inside their shapes at most (default 0.05, of cells 0.1)"};
}

struct HollowCommand {
  HollowCommand(CLI::App& command, const ConfigFile& config)
      : model(command),
        packing(command, config),
        keep_solid(command),
        drainage(command, config),
        cells(command, words_of_void_cells()),
        print(command, config),
        views(command, "the result"),
        run_options(command),
        modifier_options(config),
        flavor_option(config) {
    command.add_option("-o,--output", output, "The result: " + endings_that_are_written())
        ->required()
        ->check(names_a_file())
        ->type_name("FILE");
    command
        .add_option(
            "--as", void_form,
            "What voids become: voids (inward shells) or, in a 3MF (for Slic3r AMF), modifiers (the solid "
            "model with "
            "volumes of lower infill, round which no walls are printed; --wall is by default as thick as "
            "the perimeters)")
        ->check(CLI::IsMember({"voids", "modifiers"}))
        ->type_name("FORM")
        ->capture_default_str();
    flavor_option.add(command
                          .add_option("--flavor", flavor,
                                      "Modifiers and support blockers: those of " +
                                          listed(of_slicers(described_flavor), "or"))
                          ->check(CLI::IsMember(of_slicers(flavor_of)))
                          ->type_name("FLAVOR")
                          ->capture_default_str());
    command.add_flag(
        "--support-blockers", support_blockers,
        "Sealed voids in a 3MF: a volume for each in which the slicer of --flavor builds no supports, which "
        "would fill voids where they are built everywhere. Other programs show these volumes as bodies");
    modifier_infill_option = add_modifier_infill(command, modifier_infill);
    modifier_options.add(modifier_infill_option);
    modifier_options.add(
        command
            .add_option("--modifier-pattern", modifier_pattern,
                        "Modifiers: infill pattern inside them, if not the print's own: lightning, which "
                        "holds up what is above, so that by default they are one cell without a roof, of "
                        "--modifier-infill 15")
            ->check(CLI::IsMember({kLightning}))
            ->type_name("PATTERN"));
    command
        .add_option("--target-saving", target_saving,
                    "Stop with the fewest voids that remove this share of the model's volume, percent")
        ->check(number_between({}, 100, "%"))
        ->type_name("PERCENT");
    command
        .add_option("--target-mass", target_mass,
                    "Stop with the fewest voids that leave at most this mass of solid --material, g")
        ->check(number_between({}, 1e9, "g"))
        ->type_name("G");
    command
        .add_flag(
            "--stand{0}", stand,
            "Leave out voids until the model stands as it stood: with its centre of mass as far inside of "
            "what it stands on, and with --stand=MM further by so much (less, if negative)")
        ->type_name("[=MM]");
    command
        .add_option("--spheres", spheres,
                    "Do not pack, but use these spheres (a .csv, .json or .ply of 'aerate pack'), after the "
                    "same checks")
        ->type_name("FILE");
    command
        .add_option("--max-triangles", max_triangles,
                    "Loosen the tolerance until the result has at most so many triangles (default no limit)")
        ->check(whole_number_between(4, 4e9, "triangles"))
        ->type_name("N");
    command
        .add_option(
            "--surface", surface,
            "The outer surface: keep every triangle of the model; remesh it through a level set, which "
            "closes small holes and unites overlapping parts; auto keeps it where that can be")
        ->check(CLI::IsMember({"keep", "remesh", "auto"}))
        ->type_name("MODE")
        ->capture_default_str();
    command
        .add_option("--voxel", voxel_size,
                    "Remeshing: edge of a voxel (default a third of the wall or gap, whichever is less)")
        ->check(number_between({}, kLongest, "mm"))
        ->type_name("MM");
    command
        .add_option("--max-hole", max_hole,
                    "Remeshing: close holes up to this diameter (default a tenth of the model's diagonal)")
        ->check(number_between({}, kLongest, "mm"))
        ->type_name("MM");
    command
        .add_option("--material", material,
                    "For mass and cost: " + material_names() +
                        ", or any with --density and --price (default of the process; fdm: PLA)")
        ->type_name("NAME");
    command.add_option("--density", density, "Density in g/cm3 (default that of the material)")
        ->check(number_between({}, 100, "g/cm3"))
        ->type_name("G/CM3");
    command
        .add_option(
            "--price", price,
            "Price of a kilogram, or as --price-per says, in your currency (default that of the material)")
        ->check(number_between(0.0, 1e9, ""))
        ->type_name("PRICE");
    command
        .add_option("--price-per", price_per,
                    "What --price buys: a kg, a l of what is printed (as resin is sold), or a bulk-l of "
                    "loose powder")
        ->check(CLI::IsMember({"kg", "l", "bulk-l"}))
        ->needs("--price")
        ->type_name("UNIT")
        ->capture_default_str();
    command
        .add_option(
            "--bulk-density", bulk_density,
            "Density of the loose powder in g/cm3, for --price-per bulk-l (default that of the material)")
        ->check(number_between({}, 100, "g/cm3"))
        ->type_name("G/CM3");
  }

  // What the user gave of the material.
  MaterialFigures material_figures() const {
    MaterialFigures given{density, bulk_density, price};
    for (const PriceUnit unit : {PriceUnit::litre, PriceUnit::bulk_litre})
      if (price_per == name_of(unit)) given.per = unit;
    if (bulk_density && given.per != PriceUnit::bulk_litre)
      throw UsageError("--bulk-density without --price-per bulk-l", "it is for the price of loose powder");
    return given;
  }

  const SlicerProfile* slicer_of_flavor() const {
    return &*std::ranges::find(slicers(), std::vector{flavor}, flavor_of);
  }

  // Of a result that may be in any file that these options allow.
  std::string ending() const {
    const bool is_in_package = void_form == "modifiers" || support_blockers;
    return is_in_package ? slicer_of_flavor()->modifiers->ending : MeshFormat::stl.ending;
  }

  // Whose support blockers voids get, if any.
  const SlicerProfile* blockers(const HollowOptions& options) const {
    if (!support_blockers) return nullptr;
    if (options.modifiers)
      throw UsageError(
          "--as modifiers leaves no voids that supports could fill: --support-blockers has no use",
          "leave it out");
    if (options.drainage)
      throw UsageError("--support-blockers is for sealed voids, and these drain",
                       "leave it out, and build supports on the plate only; or leave out --drain");
    const SlicerProfile* const slicer = slicer_of_flavor();
    if (!slicer->modifiers->has_blockers)
      throw UsageError(fmt::format("files of flavor {} hold no support blockers", flavor),
                       "leave out --support-blockers");
    return slicer;
  }

  // The one target that was given, if any.
  std::optional<SavingTarget> target(const HollowOptions& options) const {
    if (!target_mass && !target_saving) return std::nullopt;
    if (target_mass && target_saving)
      throw UsageError("--target-mass and --target-saving are two targets", "give one of them");
    const char* const option = target_mass ? "--target-mass" : "--target-saving";
    if (options.modifiers)
      throw UsageError(fmt::format("{} with --as modifiers: these remove nothing", option),
                       "leave out one of them");
    if (target_mass && options.infill_is_known)
      throw UsageError("--target-mass is of solid material, and a sparse print has less",
                       "give --target-saving, or leave out what describes the print");
    return target_mass ? SavingTarget{SavingTarget::Kind::mass, *target_mass}
                       : SavingTarget{SavingTarget::Kind::share, *target_saving / 100};
  }

  // The margin that was given with --stand, 0 without one.
  std::optional<double> standing(const HollowOptions& options) const {
    if (stand.empty()) return std::nullopt;
    const auto margin = parse_number(stand);
    if (!margin || std::abs(*margin) > kLongest)
      throw UsageError(fmt::format("--stand={}: that is no margin", stand),
                       "give millimetres, as in --stand=2, or --stand alone");
    if (options.modifiers)
      throw UsageError("--stand with --as modifiers: these remove nothing", "leave out one of them");
    if (options.target)
      throw UsageError("--stand and a target both choose voids, and contradict each other",
                       "leave out one of --stand, --target-mass and --target-saving");
    return margin;
  }

  // But for the shape of voids.
  HollowOptions unshaped() const {
    HollowOptions options;
    options.model = model.path;
    options.output = output;
    options.load = model.load();
    options.weld = model.weld;
    options.packing = packing.request();
    options.keep_solid = keep_solid.regions();
    options.packing.spheres = spheres;
    options.surface =
        std::map<std::string, SurfaceMode>{
            {"auto", SurfaceMode::automatic}, {"keep", SurfaceMode::keep}, {"remesh", SurfaceMode::remesh}}
            .at(surface);
    if (void_form == "voids") modifier_options.require_none("without --as modifiers");
    if (void_form == "voids" && !support_blockers)
      flavor_option.require_none("without --as modifiers or --support-blockers");
    if (void_form == "modifiers") options.modifiers = {slicer_of_flavor(), modifier_infill};
    options = print.applied_to(std::move(options));
    // Modifiers leave the model solid: nothing is trapped in them.
    if (options.modifiers && !drainage.plugs().empty())
      throw UsageError("--as modifiers leaves no holes that --plugs could close", "leave out one of them");
    if (options.modifiers && drainage.is_asked_for())
      throw UsageError("--as modifiers leaves no voids that --drain could open", "leave out one of them");
    if (options.modifiers && drainage.opens_cavities())
      throw UsageError("--as modifiers leaves the model solid: --drain-cavities is for voids that drain",
                       "leave out one of them");
    if (options.modifiers) {
      options.packing.process = walled_by_perimeters(std::move(options.packing.process), options.print);
    } else {
      options = drainage.applied_to(std::move(options));
    }
    options.support_blockers = blockers(options);
    if (options.line_width_origin)
      options.packing.process = followed_by_lines(std::move(options.packing.process),
                                                  options.print.line_width, *options.line_width_origin);
    print.require_lines_that_fit(options);
    if (max_triangles) options.max_triangles = static_cast<std::size_t>(*max_triangles);
    options.voxel_size = voxel_size;
    options.max_hole = max_hole;
    options.material = choose_material(material.empty() ? options.packing.process.process.material : material,
                                       material_figures());
    options.target = target(options);
    options.stand = standing(options);
    options.views = views.outputs();
    return options;
  }

  HollowOptions shaped(HollowOptions options, bool makes_cells) const {
    ShapedRequest shaped = cells.applied_to(options.packing, makes_cells, default_fillet(options));
    options.packing = std::move(shaped.packing);
    options.cells = shaped.cells;
    options.tolerance = shaped.tolerance.value_or(options.tolerance);
    require_tolerance_for(options.packing.process, options.tolerance);
    if (modifier_pattern.empty() || !options.modifiers) return options;
    if (!options.modifiers->slicer->modifiers->has_lightning)
      throw UsageError(fmt::format("{} has no lightning infill", options.modifiers->slicer->name),
                       "leave out --modifier-pattern");
    const bool is_said = modifier_infill_option->count() > 0;
    return holding_lightning(std::move(options), is_said ? modifier_infill : kLightningInfill);
  }

  // The preferred one first. Unless it was said what voids are, there are others where it can be told which is better.
  std::vector<JobForm> forms() const {
    const HollowOptions options = unshaped();
    std::vector<JobForm> forms = forms_of(options);
    // What was asked for says which voids are left out: others are made where that cannot be reached.
    if (options.target || options.stand)
      for (JobForm& other : std::span(forms).subspan(1)) other.tried = FormTrial::otherwise;
    return forms;
  }

  std::vector<JobForm> forms_of(const HollowOptions& options) const {
    const std::optional<bool> asked = cells.asks_for_cells();
    const bool makes_cells = asked.value_or(is_cells_unasked(options));
    std::vector<JobForm> forms{{shaped(options, makes_cells)}};
    const bool is_sought = options.target || options.stand;
    const bool can_compare = options.drainage || (options.infill_is_known && !is_sought);
    if (cells.says_how_cells_are() || !can_compare || !may_be_cells(options.packing)) return forms;
    const ProcessChoice& limits = options.packing.process;
    const bool is_bounded =
        !is_default(limits, Limit::max_radius) || options.packing.stop.max_count != PackingStop{}.max_count;
    const bool is_sized = is_bounded || !is_default(limits, Limit::min_radius);
    if (!is_sized) add_other_sizes(forms);
    // More freedom is not to remove less.
    if (const auto usual = with_usual_limits(limits, makes_cells); usual && options.drainage) {
      HollowOptions within = options;
      within.packing.process = *usual;
      forms.push_back({shaped(std::move(within), makes_cells)});
      if (!is_bounded) add_other_sizes(forms);
    }
    if (asked) return forms;
    try {
      forms.push_back({shaped(options, !makes_cells), FormTrial::for_more_volume});
      if (!is_sized) add_other_sizes(forms);
    } catch (const UsageError&) {
      // These options leave no choice.
    }
    return forms;
  }

  // After cells that drain: cells twice as large, one for each region of the model, and smaller ones.
  static void add_other_sizes(std::vector<JobForm>& forms) {
    const HollowOptions usual = forms.back().options;
    if (!usual.cells || !usual.drainage) return;
    HollowOptions larger = usual;
    larger.packing.process = with_larger_cells(std::move(larger.packing.process));
    forms.push_back({std::move(larger), FormTrial::for_fewer_holes});
    HollowOptions single = usual;
    single.packing.stop.max_count = 1;
    forms.push_back({std::move(single), FormTrial::for_fewer_holes});
    if (auto process = with_smaller_cells(usual.packing.process)) {
      HollowOptions smaller = usual;
      smaller.packing.process = *std::move(process);
      forms.push_back({std::move(smaller), FormTrial::for_more_volume});
    }
  }

  // Whether voids are cells, if --shape does not say.
  static bool is_cells_unasked(const HollowOptions& options) {
    if (!may_be_cells(options.packing)) return false;
    if (options.modifiers) return true;
    const PackingRequest& request = options.packing;
    const PackingLimits limits = request.limits();
    return request.process.process.drainage == Drainage::needed && !limits.roof.shapes(limits.max_radius);
  }

  JobFiles files() const {
    JobFiles files{packing.inputs(model.path), {}};
    if (!output.empty()) files.outputs.emplace_back(output);
    for (NamedInput& region : keep_solid.inputs()) files.inputs.push_back(std::move(region));
    files.inputs.push_back({"list of spheres", spheres});
    files.inputs.push_back({"file of print settings", print.file()});
    if (!drainage.plugs().empty()) files.outputs.emplace_back(drainage.plugs());
    files.add_outputs(views.files());
    return files;
  }

  void run() const {
    const std::vector<JobForm> options = forms();
    run_reported(run_options, files(), [&](Monitor& monitor) { return hollow(options, monitor); });
  }

  ModelOptions model;
  PackingCommandOptions packing;
  KeepSolidOptions keep_solid;
  DrainageOptions drainage;
  CellCommandOptions cells;
  PrintOptions print;
  ViewOptions views;
  RunOptions run_options;
  ModifierOnlyOptions modifier_options, flavor_option;
  std::string output;
  std::string void_form = "voids";
  std::string flavor = of_slicers(flavor_of).front();
  double modifier_infill = ModifierOptions{}.infill_percent;
  const CLI::Option* modifier_infill_option = nullptr;
  std::string modifier_pattern;
  bool support_blockers = false;
  std::string spheres;
  std::optional<double> max_triangles;
  std::string surface = "auto";
  std::optional<double> voxel_size;
  std::optional<double> max_hole;
  std::string material;
  std::optional<double> target_mass;
  std::optional<double> target_saving;
  std::string stand;
  std::optional<double> density, bulk_density;
  std::optional<double> price;
  std::string price_per = "kg";
};

CalledResult call_hollow_with(const Call& call, const std::function<bool(const Tube& hole)>& may_open,
                              Monitor& monitor) {
  const CommandAlone<HollowCommand> alone("hollow", call);
  const HollowCommand& command = alone.job();
  std::vector<JobForm> forms = command.forms();
  for (JobForm& form : forms) {
    form.options.arrays = call.arrays;
    form.options.may_open = may_open;
  }
  CalledResult result;
  const auto keep_mesh = [&](const HollowedForm& made, const HollowReport&, Monitor&) {
    result.mesh = as_read_back(made.hollowed.carved.solid.mesh);
  };
  run_called(command.run_options, command.files(), call,
             [&] { result.report = to_json(hollow(forms, monitor, keep_mesh)); });
  return result;
}

CalledResult call_hollow(const Call& call, Monitor& monitor) {
  return call_hollow_with(call, {}, monitor);
}

}  // namespace

Mesh hollow_mesh(const Call& call, const std::function<bool(const Tube& hole)>& may_open, Monitor& monitor) {
  return call_hollow_with(call, may_open, monitor).mesh;
}

CalledCommand called_hollow() {
  return {"hollow", options_of_command<HollowCommand>, call_hollow};
}

void visit_hollow_options(const std::function<void(const CLI::Option&)>& visit) {
  const CommandAlone<HollowCommand> alone("hollow");
  for (const CLI::Option* option : alone.command_options()) visit(*option);
}

std::vector<JobForm> forms_of_hollow(const std::filesystem::path& model, const std::filesystem::path& stem,
                                     std::vector<std::string> arguments) {
  CommandAlone<HollowCommand> alone("hollow");
  arguments.insert(arguments.begin(), {"-o", stem});
  alone.parse(model, std::move(arguments));
  alone.job().output = stem.string() + alone.job().ending();
  return alone.job().forms();
}

void add_hollow_command(CLI::App& app, const ConfigFile& config) {
  CLI::App& command = *app.add_subcommand(
      "hollow", "Remove packed spheres, or the cells round them, from a model and write the result");
  command.callback([job = std::make_shared<HollowCommand>(command, config)] { job->run(); });
}

}  // namespace aerate::cli
