#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "command.hpp"
#include "plot_picture.hpp"
#include "resilin/core/csv_cell.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/fields/scalar_field.hpp"
#include "resilin/fit/plot_frame.hpp"
#include "resilin/io/atomic_file.hpp"
#include "resilin/results/line_values.hpp"
#include "resilin/results/saved_report.hpp"
#include "terminal.hpp"

namespace resilin::cli {
namespace {

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

struct PlotOptions {
  std::string folder, x = "time", title;
  std::vector<std::string> y, out;
  bool lists = false, smallest = false;
  std::vector<double> along;  ///< two points
  std::string body;
  int frame = -1;
};

/// Numbers of a run over its frames, by name.
class Series {
 public:
  explicit Series(const Json& frames) : num_frames_(frames.size()) {
    for (std::size_t i = 0; i < frames.size(); ++i) add_frame(frames[i], i);
  }

  /// The step of the scene in which each frame lies; empty where a scene has none.
  const std::vector<std::string>& steps() const { return steps_; }

  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& [name, values] : values_) all.push_back(name);
    return all;
  }
  /// Throws InputError with the nearest name.
  const std::vector<double>& find(const std::string& name, const std::string& option) const {
    const auto found = values_.find(name);
    if (found != values_.end()) return found->second;
    const std::string nearest = did_you_mean(name, names());
    throw InputError(option, "a name that --list prints", '"' + one_line(name) + '"', nearest);
  }

 private:
  void set(const std::string& name, std::size_t frame, double value) {
    auto [found, is_new] = values_.try_emplace(name);
    if (is_new) found->second.assign(num_frames_, missing);
    found->second[frame] = value;
  }

  /// A number, a vector with its length, or a table of them.
  void add(const std::string& name, const Json& value, std::size_t frame) {
    if (value.is_number()) return set(name, frame, value.get<double>());
    if (value.is_object()) {
      for (const auto& [key, part] : value.items())
        add(std::string(name).append(".").append(key), part, frame);
      return;
    }
    const auto is_number = [](const Json& part) { return part.is_number(); };
    if (!value.is_array() || value.empty() || value.size() > 3 || !std::ranges::all_of(value, is_number))
      return;
    if (value.size() == 1) return set(name, frame, value[0].get<double>());
    double square = 0;
    for (std::size_t i = 0; i < value.size(); ++i) {
      const auto component = value[i].get<double>();
      square += component * component;
      set(name + "." + "xyz"[i], frame, component);
    }
    set(name, frame, std::sqrt(square));
  }

  void add_frame(const Json& frame, std::size_t number) {
    constexpr std::pair<const char*, const char*> tables[] = {
        {"probes", "probe"},     {"reactions", "reaction"}, {"reaction_moments", "reaction_moment"},
        {"sections", "section"}, {"energy", "energy"},      {"momentum", "momentum"}};
    for (const auto& [key, name] : tables)
      if (frame.contains(key)) add(name, frame[key], number);
    for (const char* key : {"time", "load", "step", "newton_iterations", "residual_newton",
                            "min_volume_ratio", "unstable_modes"})
      if (frame.contains(key)) add(key, frame[key], number);
    if (frame.contains("step_name") && frame["step_name"].is_string()) {
      steps_.resize(num_frames_);
      steps_[number] = frame["step_name"].get<std::string>();
    }
    if (frame.contains("collider_contacts")) add("contact", frame["collider_contacts"], number);
    if (!frame.contains("contacts") || !frame["contacts"].is_array()) return;
    for (const Json& contact : frame["contacts"]) {
      std::string name = "contact";
      if (!contact.contains("bodies") || !contact["bodies"].is_array()) continue;
      for (const Json& body : contact["bodies"])
        if (body.is_string()) name.append(".").append(body.get<std::string>());
      for (const auto& [key, value] : contact.items())
        if (key != "bodies") add(std::string(name).append(".").append(key), value, number);
    }
  }

  std::size_t num_frames_;
  std::map<std::string, std::vector<double>> values_;
  std::vector<std::string> steps_;
};

constexpr std::string_view distance_name = "distance";
std::string smallest_of(const std::string& field) { return "smallest " + field; }

/// Unit of a quantity by its name; empty for a number without.
std::string unit_of(std::string_view name) {
  const auto has = [name](std::string_view word) { return name.find(word) != name.npos; };
  if (name == "time") return "s";
  if (name.starts_with("energy.")) return "J";
  if (name.starts_with("momentum.")) return has("angular") ? "kg m^2/s" : "kg m/s";
  if (name.starts_with("reaction_moment.") || (name.starts_with("section.") && has(".moment"))) return "N m";
  if (name.starts_with("reaction.") || name == "residual_newton") return "N";
  if (name.starts_with("probe.")) return has(".velocity") ? "m/s" : "m";
  if (has(".force") || has(".normal_force")) return "N";
  if (has(".pressure") || has(".mean_pressure")) return "Pa";
  if (has(".area") || has(".reference_area")) return "m^2";
  if (name == distance_name) return "m";
  for (const ScalarField& field : scalar_fields(3))
    if (name == field.name || name == smallest_of(field.name)) return field.field->unit;
  return has("gap") || has(".center") || has(".extent") || has(".width") ? "m" : "";
}

std::string label_of(const std::string& name) {
  const std::string unit = unit_of(name);
  return unit.empty() ? name : name + " [" + unit + "]";
}

struct Curve {
  std::string name;
  const std::vector<double>* values;
};

/// @param steps  names in a last column; empty: none
std::string csv(const Curve& x, const std::vector<Curve>& ys, const std::vector<std::string>& steps) {
  std::string text = csv_cell(label_of(x.name));
  for (const Curve& y : ys) text += "," + csv_cell(label_of(y.name));
  text += steps.empty() ? "\n" : ",step_name\n";
  const auto number = [](double value) { return std::isfinite(value) ? format_number(value) : ""; };
  for (std::size_t i = 0; i < x.values->size(); ++i) {
    text += number((*x.values)[i]);
    for (const Curve& y : ys) text += "," + number((*y.values)[i]);
    text += steps.empty() ? "\n" : "," + csv_cell(steps[i]) + "\n";
  }
  return text;
}

/// Whether no value is below the one before it.
bool rises(const std::vector<double>& values) {
  for (std::size_t i = 1; i < values.size(); ++i)
    if (!(values[i] >= values[i - 1])) return false;
  return true;
}

/// Where each step of the scene ends, along an axis that rises.
std::vector<PlotMark> step_marks(const Curve& x, const std::vector<std::string>& steps) {
  std::vector<PlotMark> marks;
  if (!rises(*x.values)) return marks;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const bool is_last = i + 1 == steps.size();
    if (is_last || steps[i + 1] != steps[i])
      marks.push_back({.name = steps[i], .at = (*x.values)[i], .has_line = !is_last});
  }
  return marks;
}

std::string svg_mark(const PlotFrame& frame, const PlotMark& mark) {
  const double at = frame.at_x(mark.at), end = PlotFrame::height - PlotFrame::bottom;
  std::string text;
  if (mark.has_line)
    text = fmt::format("<line class=\"step\" x1=\"{0:.2f}\" x2=\"{0:.2f}\" y1=\"{1}\" y2=\"{2}\"/>", at,
                       PlotFrame::top, end);
  return text + fmt::format("<text class=\"step\" x=\"{:.2f}\" y=\"{}\" text-anchor=\"end\">{}</text>",
                            at - 3, end - 4, html_text(mark.name));
}

constexpr std::string_view style =
    "text{font:11px sans-serif;fill:#333}.title{font-weight:bold}.grid{stroke:#ddd}.axis{stroke:#555}"
    "polyline{fill:none;stroke-width:1.8}line.step{stroke:#999;stroke-dasharray:3}text.step{fill:#777}";
constexpr const char* colours[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                   "#e69f00", "#56b4e9", "#7f3c8d", "#666666"};

/// A line in pieces, where values are missing between them.
std::string lines(const PlotFrame& frame, const Curve& x, const Curve& y, const char* colour) {
  std::string text, points;
  const auto end_piece = [&] {
    if (!points.empty())
      text += fmt::format("<polyline clip-path=\"url(#{})\" stroke=\"{}\" points=\"{}\"/>", frame.clip(),
                          colour, points);
    points.clear();
  };
  for (std::size_t i = 0; i < x.values->size(); ++i) {
    const double at = (*x.values)[i], value = (*y.values)[i];
    if (std::isfinite(at) && std::isfinite(value)) {
      points += fmt::format("{:.2f},{:.2f} ", frame.at_x(at), frame.at_y(value));
    } else {
      end_piece();
    }
  }
  end_piece();
  return text;
}

struct Plot {
  std::string title;
  Curve x;
  std::vector<Curve> ys;
  std::vector<PlotMark> marks;
  PlotAxis horizontal, vertical;

  Plot(std::string title_text, const Curve& along, std::vector<Curve> curves,
       const std::vector<std::string>& steps)
      : title(std::move(title_text)), x(along), ys(std::move(curves)), marks(step_marks(x, steps)) {
    horizontal.label = label_of(x.name);
    vertical.label = unit_of(ys[0].name);
    for (const double value : *x.values) horizontal.range.include(value);
    for (const Curve& y : ys) {
      for (const double value : *y.values) vertical.range.include(value);
      if (unit_of(y.name) != vertical.label) vertical.label = "units: see names";
    }
    if (!vertical.range.is_empty()) vertical.range = vertical.range.widened(0.05);
  }
  PlotFrame frame() const { return {title, "plot", horizontal, vertical}; }
};

constexpr const char* colour(std::size_t curve) { return colours[curve % std::size(colours)]; }

std::string svg(const Plot& plot) {
  const PlotFrame frame = plot.frame();
  std::string text = frame.open();
  text.insert(4, fmt::format(" xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\"",
                             2 * PlotFrame::width, 2 * PlotFrame::height));
  text += fmt::format("<style>{}</style><rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>", style);
  text += frame.axes();
  for (const PlotMark& mark : plot.marks) text += svg_mark(frame, mark);
  for (std::size_t i = 0; i < plot.ys.size(); ++i) {
    text += lines(frame, plot.x, plot.ys[i], colour(i));
    text += fmt::format("<text x=\"{}\" y=\"{}\" style=\"fill:{}\">{}</text>", PlotFrame::left + 6,
                        PlotFrame::top + 12 + 13 * static_cast<double>(i), colour(i),
                        html_text(label_of(plot.ys[i].name)));
  }
  return text + "</svg>\n";
}

/// "#0072b2"
Color color_of(const std::string& text) {
  const auto part = [&text](std::size_t at) {
    return static_cast<std::uint8_t>(std::stoi(text.substr(at, 2), nullptr, 16));
  };
  return {part(1), part(3), part(5)};
}

Image picture_of(const Plot& plot) {
  std::vector<PlottedCurve> curves;
  for (std::size_t i = 0; i < plot.ys.size(); ++i)
    curves.push_back({.label = label_of(plot.ys[i].name),
                      .color = color_of(colour(i)),
                      .x = *plot.x.values,
                      .y = *plot.ys[i].values});
  return plot_image(plot.frame(), plot.title, plot.horizontal, plot.vertical, curves, plot.marks);
}

/// The line of `--along`.
SurfaceLine line_of(const PlotOptions& options) {
  const std::size_t dim = options.along.size() / 2;
  if (options.along.size() != 4 && options.along.size() != 6)
    throw InputError("--along", "two points: 4 numbers in 2D, 6 in 3D", std::to_string(options.along.size()));
  SurfaceLine line{.dimension = static_cast<int>(dim), .body = options.body};
  for (std::size_t i = 0; i < dim; ++i) {
    line.from[static_cast<Eigen::Index>(i)] = options.along[i];
    line.to[static_cast<Eigen::Index>(i)] = options.along[dim + i];
  }
  return line;
}

/// The smallest of the finite numbers; nan where there are none.
double smallest(const std::vector<double>& values) {
  double least = missing;
  for (const double value : values)
    if (!(value >= least) && std::isfinite(value)) least = value;
  return least;
}

/// Curves of fields along a line, or their smallest values over the frames.
struct CurvesAlong {
  std::vector<double> distances;
  std::vector<std::vector<double>> values;

  CurvesAlong(const std::filesystem::path& folder, const PlotOptions& options) {
    if (!std::filesystem::is_directory(folder))
      throw InputError("--along", "the folder of a run", '"' + one_line(folder.string()) + '"');
    const SurfaceLine line = line_of(options);
    for (const std::string& field : options.y) {
      const LineValues found = values_along(
          folder, line, field, options.smallest ? std::nullopt : std::optional<int>(options.frame));
      distances = found.distances;
      if (!options.smallest) {
        values.push_back(found.frames.front());
        continue;
      }
      values.emplace_back();
      for (const std::vector<double>& frame : found.frames) values.back().push_back(smallest(frame));
    }
  }
};

int plot(const PlotOptions& options) {
  const std::filesystem::path folder = options.folder;
  const std::filesystem::path path = std::filesystem::is_directory(folder) ? folder / "report.json" : folder;
  const SavedReport report = read_report(path);
  const Series series(report.frames);
  if (options.lists) {
    for (const std::string& name : series.names()) print_line(label_of(name));
    return done;
  }
  if (options.y.empty())
    throw InputError("--y", "the name of what to plot, once or more", "none", "--list prints all names");
  if (options.along.empty() && (options.smallest || !options.body.empty()))
    throw InputError(options.smallest ? "--smallest" : "--body", "--along with two points beside it", "none");
  std::optional<CurvesAlong> line;
  if (!options.along.empty()) line.emplace(folder, options);
  const bool is_over_line = line && !options.smallest;
  const Curve x = is_over_line ? Curve{std::string(distance_name), &line->distances}
                               : Curve{options.x, &series.find(options.x, "--x")};
  std::vector<Curve> ys;
  for (std::size_t i = 0; i < options.y.size(); ++i) {
    const std::string& name = options.y[i];
    ys.push_back(!line              ? Curve{name, &series.find(name, "--y")}
                 : options.smallest ? Curve{smallest_of(name), &line->values[i]}
                                    : Curve{name, &line->values[i]});
    if (ys.back().values->size() != x.values->size())
      throw InputError(path.string(), "as many frames as the report has",
                       std::to_string(ys.back().values->size()) + " of " + std::to_string(x.values->size()));
  }
  const std::vector<std::string> steps = is_over_line ? std::vector<std::string>() : series.steps();
  const std::string title = options.title.empty() ? ys[0].name : options.title;
  if (options.out.empty()) print_text(csv(x, ys, steps));
  for (const std::string& file : options.out) {
    const std::string ending = std::filesystem::path(file).extension().string();
    if (ending != ".csv" && ending != ".svg" && ending != ".png")
      throw InputError(one_line(file), "a name that ends in .csv, .svg or .png",
                       '"' + one_line(ending) + '"');
  }
  const Plot drawn(title, x, ys, steps);
  for (const std::string& file : options.out) {
    const std::string ending = std::filesystem::path(file).extension().string();
    if (ending == ".png") {
      write_png(file, picture_of(drawn));
    } else {
      write_text(file, ending == ".csv" ? csv(x, ys, steps) : svg(drawn));
    }
    print_line("wrote " + one_line(file));
  }
  return done;
}

}  // namespace

void add_plot(CommandLine& line, Action& action) {
  auto options = std::make_shared<PlotOptions>();
  const Command command =
      line.command("plot", "Curves of a run: forces, displacements, energies, as CSV, SVG or PNG");
  command.option("run", options->folder, "Results folder of a run, or its report.json")
      .required()
      .is_file_or_folder({"json"});
  command.option("--x", options->x, "Quantity on the horizontal axis").type_name("NAME").shows_default();
  command.option("--y", options->y, "Quantity of a curve; repeatable").type_name("NAME").repeatable();
  command
      .option("--out", options->out,
              "File to write, .csv, .svg or .png; repeatable. Without it: CSV on stdout")
      .type_name("FILE")
      .repeatable()
      .is_file({"csv", "svg", "png"});
  command.option("--title", options->title, "Title of the picture").type_name("TEXT");
  command.flag("--list", options->lists, "List the quantities of the run");
  command
      .option("--along", options->along,
              "Ends of a line in the reference configuration: X Y X Y in 2D, X Y Z X Y Z in 3D. --y then "
              "names fields, such as contact_pressure, on the surface nearest to the line")
      .values(4, 6)
      .type_name("X Y ...");
  command.option("--body", options->body, "With --along: the body; default: the nearest").type_name("NAME");
  const Option frame =
      command.option("--frame", options->frame, "With --along: number of the frame; default -1, the last")
          .type_name("N");
  command
      .flag("--smallest", options->smallest,
            "With --along: the smallest value on the line, over the frames, such as the contact_pressure "
            "around a seal, which tells where it leaks first")
      .excludes(frame);
  command.footer(
      "Names: time, load, probe.NAME.displacement.x, reaction.NAME.y, contact.A.B.force, "
      "contact.COLLIDER.pressure, energy.elastic, ...; a vector without a component is its length. "
      "In scenes with steps a table gives the step of each row, and a picture has a line where each ends.\n"
      "Examples:\n  resilin plot out/plug --x time --y reaction.plate.y --out force.svg\n"
      "  resilin plot out/o_ring --y contact_pressure --along 0.01 0 0.012 0 --out leak.svg\n\n"
      "Exit codes: 0 done; 1 the input is wrong.");
  command.on_chosen([options, &action] { action = [options] { return plot(*options); }; });
}

}  // namespace resilin::cli
