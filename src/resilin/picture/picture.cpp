#include "resilin/picture/picture.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/picture/camera.hpp"
#include "resilin/picture/canvas.hpp"
#include "resilin/picture/canvas_projection.hpp"
#include "resilin/picture/color_bar.hpp"
#include "resilin/picture/color_map.hpp"
#include "resilin/picture/ground_shadow.hpp"
#include "resilin/picture/lighting.hpp"
#include "resilin/picture/picture_check.hpp"
#include "resilin/picture/picture_field.hpp"
#include "resilin/picture/surface.hpp"
#include "resilin/picture/text.hpp"

namespace resilin {
namespace {

/// In turn; the page has the same.
constexpr std::array<Color, 6> body_colors = {
    {{227, 154, 128}, {127, 168, 201}, {217, 179, 108}, {134, 179, 154}, {183, 154, 200}, {201, 141, 141}}};
constexpr Color plain_body = {176, 186, 198};
constexpr Color plain_collider = {128, 136, 146};
constexpr double veil_opacity = 0.3, shadow_opacity = 0.55;
constexpr std::array views_around = {
    0.12,
    0.25};  ///< distance that is seen around the bodies, relative to their extent: floors; what is farther
constexpr double hollow_size = 0.05;  ///< size of hollow marks, relative to the shorter side of the picture
constexpr Color not_a_number = {214, 64, 200};

/// Points of the shape at `factor` times the displacement, 0 for the rest shape.
std::vector<Vector3> shape(const VtuContent& frame, double factor, const std::string& what) {
  std::vector<Vector3> points = frame.file.mesh.vertices;
  if (factor == 1) return points;
  const auto found = std::ranges::find(frame.point_data, "displacement", &VtuValues::name);
  if (found == frame.point_data.end() || found->components != 3)
    throw InputError(what, "a frame with the field displacement", "none",
                     "add \"displacement\" to `output.fields` of the scene");
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i] += (factor - 1) * Eigen::Map<const Vector3>(found->values.data() + 3 * i);
  return points;
}

Vector3 vertical_of(const PictureOptions& options) {
  return options.up == "auto" ? options.vertical : axis_of(options.up);
}

/// The parts of one picture.
class Picture {
 public:
  Picture(const VtuContent& frame, const PictureOptions& options, const Mesh& colliders)
      : frame_(frame),
        colliders_(colliders),
        options_(options),
        ink_(options.is_dark ? Color{226, 228, 232} : Color{30, 32, 36}),
        pen_(std::clamp(0.024 * options.height, 11.0, 40.0)),
        points_(shape(frame, options.scale, "scale")),
        surface_(find_surface(frame.file.mesh.blocks, points_, options.has_skins)),
        // The background is found by the two pictures that differ most.
        canvas_(options.width, options.height,
                options.is_transparent ? black
                : options.is_dark      ? dusk
                                       : white,
                options.is_transparent ? std::optional(white) : std::nullopt) {
    if (surface_.triangles.empty())
      throw InputError("frame", "triangles, quadrilaterals, tetrahedra or hexahedra", "none");
    if (options.shows_rest) rest_ = shape(frame, 0, "rest");
    find_bodies();
    if (shows_field()) choose_colors();
  }

  Image draw() {
    place();
    draw_surface();
    if (surface_.dimension == 3)  // less on a field, whose colours are to be found on the bar
      canvas_.darken_hollows(hollow_size * std::min(options_.width, options_.height),
                             shows_field() ? 0.45 : 0.9);
    draw_edges();
    if (options_.shows_rest) draw_rest();
    if (options_.shows_colliders && !colliders_.blocks.empty()) draw_colliders();
    draw_axes();
    Image image = canvas_.image();
    write_on(image);
    if (!options_.is_transparent) return image;
    Image over_other = canvas_.image_over_other();
    write_on(over_other);
    return see_through(image, over_other);
  }

 private:
  static constexpr Color black = {0, 0, 0}, white = {255, 255, 255}, dusk = {27, 30, 36};

  bool shows_field() const { return !options_.field.empty() && options_.field != no_field; }
  void write_on(Image& image) const {
    image.view = view_;
    if (shows_field()) image.legend = text_.title + ": " + text_.extremes;
    name_axes(image);
    if (shows_bar()) draw_color_bar(image, scale_, text_, pen_, ink_);
    if (const double em = pen_.digit_height(); options_.shows_caption)
      pen_.draw(image, 1.5 * em, 2.8 * em, options_.caption, ink_);
  }

  bool shows_bar() const { return shows_field() && options_.shows_bar; }

  /// Finds the body of each cell, where the frame knows.
  void find_bodies() {
    const auto found = std::ranges::find(frame_.cell_data, "body", &VtuValues::name);
    if (found != frame_.cell_data.end() && found->components == 1) bodies_ = found->values;
  }

  /// Numbers of the bodies that have the field: a rigid one has but its motion.
  std::set<double> bodies_with_values() const {
    std::set<double> numbers;
    for (const auto& triangle : surface_.triangles)
      for (const DrawnSurface::Corner& corner : triangle)
        if (std::isfinite(value(corner))) numbers.insert(body_of(corner.cell));
    return numbers;
  }

  Color color_of_body(double number) const {
    if (bodies_.empty() || !(number > -0.5)) return plain_body;
    return body_colors[static_cast<std::size_t>(std::lround(number)) % body_colors.size()];
  }

  void choose_colors() {
    field_ = pick_field(frame_, options_.field, "field");
    scale_ = choose_scale(all_values(), options_.range, options_.map, options_.smallest_range);
    std::string label = options_.label;
    if (label.empty()) label = field_.name + (field_.component.empty() ? "" : ", " + field_.component);
    text_ = scale_text(scale_, label, options_.unit);
  }

  /// Those whose range the report has: of all cells, or of all nodes that cells use, seen or not.
  std::vector<double> all_values() const {
    if (options_.extremes) return {(*options_.extremes)[0], (*options_.extremes)[1]};
    if (!field_.is_on_points) return field_.values;
    std::vector<bool> is_used(field_.values.size(), false);
    std::vector<double> values;
    for (const CellBlock& block : frame_.file.mesh.blocks)
      for (const Index node : block.nodes) {
        const auto i = static_cast<std::size_t>(node);
        if (!is_used[i]) values.push_back(field_.values[i]);
        is_used[i] = true;
      }
    return values;
  }

  double body_of(Index cell) const {
    const auto i = static_cast<std::size_t>(cell);
    return i < bodies_.size() ? bodies_[i] : -1;
  }

  double value(const DrawnSurface::Corner& corner) const {
    const auto number = [&](Index i) { return field_.values[static_cast<std::size_t>(i)]; };
    // Contact acts on the flat parts between nodes; a parabola through its values would go below zero.
    const bool is_by_parts = field_.name.starts_with("contact_");
    return field_.is_on_points ? DrawnSurface::at(corner, number, is_by_parts) : number(corner.cell);
  }

  static Vector3 position(const DrawnSurface::Corner& corner, const std::vector<Vector3>& points) {
    return DrawnSurface::at(corner, [&](Index i) -> Vector3 { return points[static_cast<std::size_t>(i)]; });
  }

  void place() {
    std::vector<Vector3> shown;
    for (const auto& triangle : surface_.triangles)
      for (const DrawnSurface::Corner& corner : triangle) {
        shown.push_back(position(corner, points_));
        if (!rest_.empty()) shown.push_back(position(corner, rest_));
      }
    if (options_.shows_colliders) add_near_colliders(shown);
    note_view(shown);
    if (options_.reach) shown = corners_of((*options_.reach)[0], (*options_.reach)[1]);
    const double margin = 0.06 * std::min(options_.width, options_.height);
    const double right = shows_bar() ? margin / 2 + color_bar_width(text_, pen_) : margin;
    const Camera camera = choose_camera();
    view_.toward = camera.toward;
    projection_ = fit(
        camera, shown,
        {margin, margin, options_.width - right, options_.height - std::max(margin, 0.09 * options_.height)});
  }

  static std::vector<Vector3> corners_of(const Vector3& low, const Vector3& high) {
    std::vector<Vector3> corners;
    for (int i = 0; i < 8; ++i)
      corners.emplace_back(i & 1 ? high.x() : low.x(), i & 2 ? high.y() : low.y(),
                           i & 4 ? high.z() : low.z());
    return corners;
  }

  void note_view(const std::vector<Vector3>& shown) {
    view_.low = view_.high = shown.front();
    for (const Vector3& point : shown) {
      view_.low = view_.low.cwiseMin(point);
      view_.high = view_.high.cwiseMax(point);
    }
    view_.extremes = {scale_.least, scale_.greatest};
    view_.up = vertical_of(options_);
  }

  Camera choose_camera() const {
    const Vector3 up = vertical_of(options_);
    if (surface_.dimension == 2 || options_.view != "auto")
      return make_camera(surface_.dimension, surface_.dimension == 2 ? "front" : options_.view, up);
    const auto found = std::ranges::find(frame_.point_data, "displacement", &VtuValues::name);
    const bool knows_motion = found != frame_.point_data.end() && found->components == 3;
    std::vector<Vector3> corners, moved;
    for (const auto& triangle : surface_.triangles)
      for (const DrawnSurface::Corner& corner : triangle) {
        corners.push_back(position(corner, points_));
        if (!knows_motion) continue;
        moved.push_back(DrawnSurface::at(corner, [&](Index i) -> Vector3 {
          return Eigen::Map<const Vector3>(found->values.data() + 3 * static_cast<std::size_t>(i));
        }));
      }
    return make_camera(telling_direction(corners, moved, up), up);
  }

  /// Adds the part of the colliders that is seen around the bodies.
  void add_near_colliders(std::vector<Vector3>& shown) const {
    Vector3 low = Vector3::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (const Vector3& point : shown) {
      low = low.cwiseMin(point);
      high = high.cwiseMax(point);
    }
    const double extent = (high - low).maxCoeff();
    for (const CellBlock& block : colliders_.blocks)
      for (Index cell = 0; cell < block.num_cells(); ++cell) {  // the part of its box that is in ours
        Vector3 least = Vector3::Constant(std::numeric_limits<double>::infinity()), greatest = -least;
        for (const Index node : block.cell(cell)) {
          const Vector3& point = colliders_.vertices[static_cast<std::size_t>(node)];
          least = least.cwiseMin(point);
          greatest = greatest.cwiseMax(point);
        }
        for (const double around : views_around) {
          const Vector3 margin = Vector3::Constant(around * extent);
          const Vector3 from = least.cwiseMax(low - margin), to = greatest.cwiseMin(high + margin);
          if ((from.array() > to.array()).any()) continue;
          shown.insert(shown.end(), {from, to});
          break;
        }
      }
  }

  /// The pieces of a line that leave the words and the bar free.
  std::vector<std::array<Vector3, 2>> beside_words(const Vector3& from, const Vector3& to) const {
    std::vector<std::array<double, 2>> pieces = {{0, 1}};  // parameters along the line
    if (!shows_bar()) return {{from, to}};
    for (const PictureBox& box : color_bar_boxes(options_.width, options_.height, text_, pen_)) {
      double enters = 0, leaves = 1;
      const auto clip = [&](double start, double way, double low, double high) {
        if (way == 0) {
          if (start < low || start > high) leaves = -1;
          return;
        }
        const auto [first, last] = std::minmax({(low - start) / way, (high - start) / way});
        enters = std::max(enters, first);
        leaves = std::min(leaves, last);
      };
      clip(from.x(), to.x() - from.x(), box.left, box.right);
      clip(from.y(), to.y() - from.y(), box.top, box.bottom);
      if (!(enters <= leaves)) continue;
      std::vector<std::array<double, 2>> left;
      for (const auto& [begin, end] : pieces) {
        if (begin < std::min(end, enters)) left.push_back({begin, std::min(end, enters)});
        if (std::max(begin, leaves) < end) left.push_back({std::max(begin, leaves), end});
      }
      pieces = std::move(left);
    }
    std::vector<std::array<Vector3, 2>> shown;
    for (const auto& [begin, end] : pieces)
      shown.push_back({from + begin * (to - from), from + end * (to - from)});
    return shown;
  }

  void draw_colliders() {
    const double unit = options_.height / 900.0;
    const GroundShadow shadow = shadow_of_bodies();
    for (const CellBlock& block : colliders_.blocks) {
      if (block.kind != CellKind::triangle) {
        const bool is_point = block.kind == CellKind::point;
        for (Index cell = 0; cell < block.num_cells(); ++cell) {
          const auto place_of = [&](Index vertex) {
            return projection_(colliders_.vertices[static_cast<std::size_t>(vertex)]);
          };
          for (const auto& [from, to] :
               beside_words(place_of(block.cell(cell).front()), place_of(block.cell(cell).back())))
            canvas_.line(from, to, (is_point ? 6 : 3) * unit, 0, {plain_collider, 1});
        }
        continue;
      }
      const DrawnSurface facets = find_surface({block}, colliders_.vertices);
      for (const auto& triangle : facets.triangles) {
        std::array<CanvasVertex, 3> corners;
        for (std::size_t i = 0; i < 3; ++i)
          corners[i] = {.place = projection_(position(triangle[i], colliders_.vertices)),
                        .value = 0,
                        .light = light(projection_.camera.turned(triangle[i].normal))};
        // Light comes from above: a wall has no shadow.
        const double lies = std::abs(triangle[0].normal.dot(vertical_of(options_).normalized()));
        canvas_.veil(corners, [&](const Vector3& place, double brightness) -> Canvas::VeilShade {
          const double dark = lies * shadow.at(projection_.point_at(place));
          return {mix(shaded(plain_collider, brightness), {0, 0, 0}, 0.8 * dark),
                  veil_opacity + (shadow_opacity - veil_opacity) * dark};
        });
      }
      for (const DrawnSurface::Line& edge : facets.edges)
        if (edge.is_feature) draw_line(edge, colliders_.vertices, 1.2 * unit, unit, {plain_collider, 0.9});
    }
  }

  GroundShadow shadow_of_bodies() const {
    std::vector<std::array<Vector3, 3>> triangles;
    if (surface_.dimension == 3)
      for (const auto& triangle : surface_.triangles)
        triangles.push_back(
            {position(triangle[0], points_), position(triangle[1], points_), position(triangle[2], points_)});
    return {triangles, vertical_of(options_).normalized()};
  }

  void draw_surface() {
    constexpr std::size_t steps = 1024;
    std::vector<Color> colors;
    for (std::size_t i = 0; i <= steps; ++i)
      colors.push_back(map_color(scale_.map, static_cast<double>(i) / steps));
    const bool is_plain = !shows_field();
    bool has_field = true;
    const auto shader = [&](double value, double brightness) {
      if (is_plain) return shaded(color_of_body(value), brightness);
      if (!has_field) return shaded_field(plain_body, brightness);
      if (!std::isfinite(value)) return shaded_field(not_a_number, brightness);
      const double t = std::clamp(scale_.place(value), 0.0, 1.0);
      return shaded_field(colors[static_cast<std::size_t>(std::lround(t * steps))], brightness);
    };
    const std::set<double> with_values = is_plain ? std::set<double>() : bodies_with_values();
    for (const auto& triangle : surface_.triangles) {
      has_field = with_values.empty() || with_values.contains(body_of(triangle[0].cell));
      std::array<CanvasVertex, 3> corners;
      for (std::size_t i = 0; i < 3; ++i)
        corners[i] = {
            .place = projection_(position(triangle[i], points_)),
            .value = is_plain ? body_of(triangle[i].cell) : value(triangle[i]),
            .light = surface_.dimension == 2 ? 1 : light(projection_.camera.turned(triangle[i].normal))};
      canvas_.triangle(corners, shader);
    }
  }

  void draw_line(const DrawnSurface::Line& line, const std::vector<Vector3>& points, double width,
                 double lift, const Ink& ink) {
    for (std::size_t i = 0; i + 1 < line.points.size(); ++i)
      canvas_.line(projection_(position(line.points[i], points)),
                   projection_(position(line.points[i + 1], points)), width, lift, ink);
  }

  /// The middle one of the lengths of all edges [pixels].
  double usual_edge() const {
    std::vector<double> lengths;
    for (const DrawnSurface::Line& edge : surface_.edges)
      lengths.push_back((projection_(position(edge.points.front(), points_)) -
                         projection_(position(edge.points.back(), points_)))
                            .norm());
    const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
    std::nth_element(lengths.begin(), middle, lengths.end());
    return *middle;
  }

  void draw_edges() {
    const double unit = options_.height / 900.0, lift = 1.5 * unit;
    // The edges of a skin mean nothing.
    const bool is_auto = options_.edges == "auto" && !options_.has_skins;
    const bool shows_all = options_.edges == "on" || (is_auto && usual_edge() > 9 * unit);
    const bool shows_features = options_.edges == "on" || is_auto;
    for (const DrawnSurface::Line& edge : surface_.edges) {
      if (edge.is_feature && shows_features)
        draw_line(edge, points_, 1.5 * unit, lift, {{0, 0, 0}, 0.75});
      else if (shows_all)
        draw_line(edge, points_, std::max(0.8 * unit, 0.5), lift, {{0, 0, 0}, 0.35});
    }
  }

  void draw_rest() {
    const double unit = options_.height / 900.0;
    for (const DrawnSurface::Line& edge :
         find_surface(frame_.file.mesh.blocks, rest_, options_.has_skins).edges)
      if (edge.is_feature) draw_line(edge, rest_, 1.4 * unit, 0, {ink_, 0.55});
  }

  std::size_t num_axes() const { return surface_.dimension == 2 ? 2 : 3; }
  Vector3 axes_origin() const {
    const double em = pen_.digit_height();
    return {4.5 * em, options_.height - 4.5 * em, 1e6};  // in front of everything
  }

  Vector3 axis_tip(std::size_t axis, double length) const {
    const Vector3 turned = projection_.camera.turned(Vector3::Unit(static_cast<Eigen::Index>(axis)));
    return axes_origin() + length * pen_.digit_height() * Vector3(turned.x(), -turned.y(), turned.z());
  }

  static Color axis_color(std::size_t axis) {
    constexpr std::array<Color, 3> colors = {{{208, 62, 52}, {46, 148, 70}, {54, 104, 210}}};
    return colors[axis];
  }

  void draw_axes() {
    for (std::size_t axis = 0; axis < num_axes(); ++axis)
      canvas_.line(axes_origin(), axis_tip(axis, 3), 0.22 * pen_.digit_height(), 0, {axis_color(axis), 1});
  }

  void name_axes(Image& image) const {
    for (std::size_t axis = 0; axis < num_axes(); ++axis) {
      const std::string name(1, "xyz"[axis]);
      const Vector3 end = axis_tip(axis, 3.7);
      pen_.draw(image, end.x() - pen_.width(name) / 2, end.y() + 0.4 * pen_.digit_height(), name,
                axis_color(axis));
    }
  }

  const VtuContent& frame_;
  const Mesh& colliders_;
  const PictureOptions& options_;
  Color ink_;
  TextPen pen_;
  std::vector<Vector3> points_, rest_;
  DrawnSurface surface_;
  Canvas canvas_;
  PictureField field_;
  std::vector<double> bodies_;  ///< number of the body of each cell; empty where it is not known
  ColorScale scale_;
  ScaleText text_;
  CanvasProjection projection_;
  Image::View view_;
};

}  // namespace

Image draw_picture(const VtuContent& frame, const PictureOptions& options, const Mesh& colliders) {
  check_picture(options);
  return Picture(frame, options, colliders).draw();
}

}  // namespace resilin
