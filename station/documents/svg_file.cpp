#include "station/documents/svg_file.h"

#include <2geom/pathvector.h>
#include <2geom/svg-path-parser.h>
#include <2geom/transforms.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <pugixml.hpp>
#include <set>
#include <stdexcept>

#include "station/documents/degree.h"
#include "station/documents/disk/shown_text.h"
#include "station/documents/number_text.h"
#include "station/documents/srgb.h"
#include "station/documents/text_pieces.h"

namespace station {
namespace {

using Eigen::Vector2d;

constexpr double kPixel_mm = 25.4 / 96;
constexpr double kFarthest_mm = 1e4;
constexpr double kShortestDirection_mm = 0.01, kSmallestArea_mm2 = 0.02;  // the latter twice the area
constexpr int kDeepest = 200;

// Numbers of a list, apart by spaces and commas; none where something else stands between.
std::optional<std::vector<double>> numbers(std::string_view text) {
  std::vector<double> found;
  const char *at = text.data(), *end = at + text.size();
  for (;;) {
    while (at != end && (std::isspace(static_cast<unsigned char>(*at)) || *at == ',')) ++at;
    if (at == end) return found;
    if (*at == '+') ++at;
    double value = 0;
    const auto [rest, error] = std::from_chars(at, end, value);
    if (error != std::errc() || !std::isfinite(value)) return std::nullopt;
    found.push_back(value), at = rest;
  }
}

class SvgReader {
 public:
  explicit SvgReader(const std::string& source) : source_(source) {}

  renderer::LineArt read(std::string_view text) {
    pugi::xml_document document;
    const pugi::xml_parse_result parsed = document.load_buffer(text.data(), text.size());
    const pugi::xml_node root = document.child("svg");
    if (!parsed || !root)
      fail("no drawing (" + (parsed ? "found no <svg> element" : std::string(parsed.description())) +
           "); export the motif as plain SVG");
    art_.name = trimmed(root.child("title").text().get());
    read_rules(root, 0);
    walk(root, {}, Geom::Affine(Geom::Scale(unit_mm(root))));
    if (art_.lines.empty()) fail("has no line to sew; give paths a stroke");
    return art_;
  }

 private:
  using Style = std::map<std::string, std::string>;  // what is inherited
  struct Direction {
    Vector2d middle;
    double along_rad;
  };

  [[noreturn]] void fail(const std::string& what) const { throw std::runtime_error(source_ + ": " + what); }

  [[noreturn]] void fail_at(const pugi::xml_node& node, const std::string& what) const {
    const std::string id = node.attribute("id").value();
    fail("<" + std::string(node.name()) + (id.empty() ? "" : " id=\"" + shown_text(id) + "\"") + ">: " + what);
  }

  // The millimetres of a length with its unit; percentages have none.
  std::optional<double> length_mm(const std::string& text) const {
    static const std::map<std::string, double> units{{"", kPixel_mm}, {"px", kPixel_mm}, {"mm", 1},        {"cm", 10},
                                                     {"in", 25.4},    {"pt", 25.4 / 72}, {"pc", 25.4 / 6}, {"Q", 0.25}};
    const std::string length = trimmed(text);
    double value = 0;
    const auto [rest, error] = std::from_chars(length.data(), length.data() + length.size(), value);
    const auto unit = units.find(std::string(rest, length.data() + length.size()));
    if (error != std::errc() || unit == units.end() || !std::isfinite(value)) return std::nullopt;
    return value * unit->second;
  }

  // The millimetres of one user unit of the whole drawing.
  double unit_mm(const pugi::xml_node& root) const {
    const auto box = numbers(root.attribute("viewBox").value());
    if (!root.attribute("viewBox")) return kPixel_mm;
    if (!box || box->size() != 4 || !((*box)[2] > 0) || !((*box)[3] > 0))
      fail("found the viewBox \"" + shown_text(root.attribute("viewBox").value(), 60) +
           "\", expected left, top, width and height");
    std::optional<double> unit;
    for (const auto& [name, size] : {std::pair("width", (*box)[2]), std::pair("height", (*box)[3])})
      if (const auto length = length_mm(root.attribute(name).value()); length && *length > 0)
        unit = std::min(unit.value_or(*length / size), *length / size);
    return unit.value_or(kPixel_mm);
  }

  static void declare(std::string_view declarations, Style& style) {
    while (!declarations.empty()) {
      const std::size_t end = std::min(declarations.find(';'), declarations.size());
      const std::string_view one = declarations.substr(0, end);
      if (const auto colon = one.find(':'); colon != std::string_view::npos)
        style[trimmed(one.substr(0, colon))] = trimmed(one.substr(colon + 1));
      declarations.remove_prefix(std::min(end + 1, declarations.size()));
    }
  }

  // ".a, .b { stroke: red }" of every <style>.
  void read_rules(const pugi::xml_node& node, int depth) {
    if (depth > kDeepest) fail("groups lie within more than 200 others; flatten the drawing");
    for (const pugi::xml_node& child : node.children()) {
      if (std::string_view(child.name()) != "style") {
        read_rules(child, depth + 1);
        continue;
      }
      std::string rules;
      for (const pugi::xml_node& text : child.children()) rules += text.value();
      for (std::size_t at = 0;;) {
        const std::size_t open = rules.find('{', at), close = rules.find('}', open);
        if (close == std::string::npos) break;
        std::string_view selectors = std::string_view(rules).substr(at, open - at);
        while (!selectors.empty()) {
          const std::size_t end = std::min(selectors.find(','), selectors.size());
          const std::string selector = trimmed(selectors.substr(0, end));
          if (selector.starts_with('.'))
            declare(std::string_view(rules).substr(open + 1, close - open - 1), rules_[selector.substr(1)]);
          selectors.remove_prefix(std::min(end + 1, selectors.size()));
        }
        at = close + 1;
      }
    }
  }

  Style style_of(const pugi::xml_node& node, Style style) const {
    style.erase("display");  // is not inherited, but a group that is not shown is not walked
    for (const char* name : {"stroke", "stroke-width", "fill", "fill-rule", "color", "display", "visibility"})
      if (node.attribute(name)) style[name] = trimmed(node.attribute(name).value());
    std::string_view classes = node.attribute("class").value();
    for (std::size_t at = 0; at < classes.size();) {
      const std::size_t end = std::min(classes.find_first_of(" \t\r\n", at), classes.size());
      if (const auto rule = rules_.find(std::string(classes.substr(at, end - at))); rule != rules_.end())
        for (const auto& [name, value] : rule->second) style[name] = value;
      at = end + 1;
    }
    declare(node.attribute("style").value(), style);
    return style;
  }

  Geom::Affine transform_of(const pugi::xml_node& node) const {
    std::string_view text = node.attribute("transform").value();
    Geom::Affine whole = Geom::identity();
    const auto refuse = [&] {
      fail_at(node, "found the transform \"" + shown_text(node.attribute("transform").value(), 60) +
                        "\", expected matrix, translate, scale, rotate, skewX or skewY");
    };
    for (;;) {
      const auto first = text.find_first_not_of(" \t\r\n,");
      if (first == std::string_view::npos) return whole;
      const std::size_t open = text.find('(', first), close = text.find(')', first);
      if (open == std::string_view::npos || close == std::string_view::npos || close < open) refuse();
      const std::string name = trimmed(text.substr(first, open - first));
      const auto found = numbers(text.substr(open + 1, close - open - 1));
      if (!found) refuse();
      const std::vector<double>& v = *found;
      const std::size_t n = v.size();
      Geom::Affine one = Geom::identity();
      if (name == "matrix" && n == 6)
        one = Geom::Affine(v[0], v[1], v[2], v[3], v[4], v[5]);
      else if (name == "translate" && (n == 1 || n == 2))
        one = Geom::Translate(v[0], n == 2 ? v[1] : 0);
      else if (name == "scale" && (n == 1 || n == 2))
        one = Geom::Affine(v[0], 0, 0, n == 2 ? v[1] : v[0], 0, 0);
      else if (name == "rotate" && n == 1)
        one = Geom::Rotate(v[0] * kDegree);
      else if (name == "rotate" && n == 3)
        one = Geom::Translate(-v[1], -v[2]) * Geom::Rotate(v[0] * kDegree) * Geom::Translate(v[1], v[2]);
      else if (name == "skewX" && n == 1)
        one = Geom::Affine(1, 0, std::tan(v[0] * kDegree), 1, 0, 0);
      else if (name == "skewY" && n == 1)
        one = Geom::Affine(1, std::tan(v[0] * kDegree), 0, 1, 0, 0);
      else
        refuse();
      whole = one * whole;  // the last one written comes first
      text.remove_prefix(close + 1);
    }
  }

  std::optional<Srgb8> colour_of(const pugi::xml_node& node, const Style& style, const std::string& key) const {
    const auto found = style.find(key);
    std::string text = found == style.end() ? (key == "fill" ? "black" : "none") : found->second;
    if (text == "currentColor") text = style.contains("color") ? style.at("color") : "black";
    if (text == "none" || text == "transparent") return std::nullopt;
    if (const auto named = named_colour(text)) return named;
    const bool is_short = text.size() == 4 && text[0] == '#';
    if (const auto colour =
            hex_colour(is_short ? std::string{'#', text[1], text[1], text[2], text[2], text[3], text[3]} : text))
      return colour;
    if (text.starts_with("rgb(") && text.ends_with(')'))
      if (const auto v = numbers(std::string_view(text).substr(4, text.size() - 5)); v && v->size() == 3) {
        Srgb8 colour{};
        for (std::size_t c = 0; c < 3; ++c)
          colour[c] = static_cast<unsigned char>(std::lround(std::clamp((*v)[c], 0.0, 255.0)));
        return colour;
      }
    fail_at(node, "found the " + key + " \"" + shown_text(text) +
                      "\", which is no colour of one thread; write it like #c01830");
  }

  double number(const pugi::xml_node& node, const char* name) const {
    const pugi::xml_attribute attribute = node.attribute(name);
    if (!attribute) return 0;
    const auto found = length_mm(attribute.value());
    if (!found)
      fail_at(node, "found " + std::string(name) + "=\"" + shown_text(attribute.value()) + "\", expected a number");
    return *found / kPixel_mm;
  }

  // The outline as path data; empty where the element has none.
  std::string data_of(const pugi::xml_node& node) const {
    const std::string kind = node.name();
    const auto n = [&](const char* name) { return number(node, name); };
    const auto at = [](double x, double y) { return shortest_text(x) + "," + shortest_text(y) + " "; };
    if (kind == "path") return node.attribute("d").value();
    if (kind == "line") return "M" + at(n("x1"), n("y1")) + "L" + at(n("x2"), n("y2"));
    if (kind == "polyline" || kind == "polygon") {
      const auto points = numbers(node.attribute("points").value());
      if (!points || points->size() % 2 != 0) fail_at(node, "its points are not pairs of numbers");
      std::string data;
      for (std::size_t i = 0; i < points->size(); i += 2)
        data += (i == 0 ? "M" : "L") + at((*points)[i], (*points)[i + 1]);
      return data.empty() || kind == "polyline" ? data : data + "Z";
    }
    if (kind == "rect") {
      const double x = n("x"), y = n("y"), w = n("width"), h = n("height");
      if (!(w > 0) || !(h > 0)) return "";
      double rx = n(node.attribute("rx") ? "rx" : "ry"), ry = n(node.attribute("ry") ? "ry" : "rx");
      rx = std::clamp(rx, 0.0, w / 2), ry = std::clamp(ry, 0.0, h / 2);
      if (rx == 0 || ry == 0)
        return "M" + at(x, y) + "h" + shortest_text(w) + "v" + shortest_text(h) + "h" + shortest_text(-w) + "Z";
      const std::string arc = "a" + at(rx, ry) + "0 0 1 ";
      return "M" + at(x + rx, y) + "h" + shortest_text(w - 2 * rx) + arc + at(rx, ry) + "v" +
             shortest_text(h - 2 * ry) + arc + at(-rx, ry) + "h" + shortest_text(2 * rx - w) + arc + at(-rx, -ry) +
             "v" + shortest_text(2 * ry - h) + arc + at(rx, -ry) + "Z";
    }
    if (kind == "circle" || kind == "ellipse") {
      const double rx = n(kind == "circle" ? "r" : "rx"), ry = n(kind == "circle" ? "r" : "ry");
      if (!(rx > 0) || !(ry > 0)) return "";
      const std::string arc = "a" + at(rx, ry) + "0 0 1 ";
      return "M" + at(n("cx") - rx, n("cy")) + arc + at(2 * rx, 0) + arc + at(-2 * rx, 0) + "Z";
    }
    return "";
  }

  // As deep as read_rules has let it be.
  void walk(const pugi::xml_node& node, const Style& inherited, const Geom::Affine& outer) {
    static const std::set<std::string> without_lines{"text", "image", "use", "foreignObject", "switch"};
    static const std::set<std::string> groups{"svg", "g", "a"};
    static const std::set<std::string> shapes{"path", "line", "polyline", "polygon", "rect", "circle", "ellipse"};
    const std::string kind = node.name();
    const Style style = style_of(node, inherited);
    if (const auto shown = style.find("display"); shown != style.end() && shown->second == "none") return;
    if (without_lines.contains(kind)) fail_at(node, "has no lines of its own; convert it to paths");
    if (groups.contains(kind)) {
      const Geom::Affine mm = transform_of(node) * outer;
      const std::vector<Direction> of_outer_group = directions_;
      std::vector<Direction> own;
      for (const pugi::xml_node& child : node.children())
        if (is_direction(child)) own.push_back(direction_of(child, transform_of(child) * mm));
      if (!own.empty()) directions_ = own;
      for (const pugi::xml_node& child : node.children())
        if (!is_direction(child)) walk(child, style, mm);
      directions_ = of_outer_group;
    } else if (shapes.contains(kind)) {
      const auto visible = style.find("visibility");
      if (visible == style.end() || visible->second == "visible") draw(node, style, transform_of(node) * outer);
    }
  }

  static bool is_direction(const pugi::xml_node& node) {
    const std::string classes = " " + std::string(node.attribute("class").value()) + " ";
    return classes.find(" direction ") != classes.npos;
  }

  Direction direction_of(const pugi::xml_node& node, const Geom::Affine& mm) {
    for (const Geom::Path& path : paths_of(node, mm)) {
      const std::vector<Vector2d> line = followed(node, path);
      if (line.size() < 2 || (line.back() - line.front()).norm() < kShortestDirection_mm) continue;
      const Vector2d along = line.back() - line.front();
      return {.middle = line[line.size() / 2], .along_rad = std::atan2(along.y(), along.x())};
    }
    fail_at(node, "is to be a direction and leads nowhere; draw it as a line");
  }

  Geom::PathVector paths_of(const pugi::xml_node& node, const Geom::Affine& mm) const {
    const std::string data = data_of(node);
    try {
      return Geom::parse_svg_path(data.c_str()) * mm;
    } catch (const std::exception&) {  // those of lib2geom have no other base in common
      fail_at(node, "its path data cannot be read; export the drawing again");
    }
  }

  // A shape is filled first, then its outline is drawn.
  void draw(const pugi::xml_node& node, const Style& style, const Geom::Affine& mm) {
    const std::optional<Srgb8> stroke = colour_of(node, style, "stroke"), fill = colour_of(node, style, "fill");
    if (!stroke && !fill) return;
    std::vector<std::vector<Vector2d>> lines;
    for (const Geom::Path& path : paths_of(node, mm))
      if (std::vector<Vector2d> line = followed(node, path); line.size() >= 2) lines.push_back(std::move(line));
    if (fill) add_shape(*fill, style, lines);
    if (!stroke) return;
    const auto given = style.find("stroke-width");
    const auto width = given == style.end() ? std::optional(kPixel_mm) : length_mm(given->second);
    if (!width || !(*width >= 0)) fail_at(node, "found the stroke-width \"" + given->second + "\", expected a length");
    const double width_mm = *width / kPixel_mm * std::sqrt(std::abs(mm.det()));
    for (std::vector<Vector2d>& line : lines)
      art_.lines.push_back({.srgb = *stroke, .width_mm = width_mm, .points = std::move(line)});
  }

  // Lines that hold no place between them, such as a straight one, have nothing to fill.
  void add_shape(const Srgb8& colour, const Style& style, const std::vector<std::vector<Vector2d>>& lines) {
    renderer::ArtLine shape{.srgb = colour};
    Vector2d low = Vector2d::Constant(kFarthest_mm), high = -low;
    for (const std::vector<Vector2d>& line : lines) {
      double twice_mm2 = 0;
      for (std::size_t i = 0; i < line.size(); ++i) {
        const Vector2d &a = line[i] - line[0], &b = line[(i + 1) % line.size()] - line[0];
        twice_mm2 += a.x() * b.y() - a.y() * b.x();
        low = low.cwiseMin(line[i]), high = high.cwiseMax(line[i]);
      }
      if (std::abs(twice_mm2) > kSmallestArea_mm2) shape.area.push_back(line);
    }
    if (shape.area.empty()) return;
    const auto rule = style.find("fill-rule");
    shape.even_odd = rule != style.end() && rule->second == "evenodd";
    const Vector2d middle = (low + high) / 2;
    const auto nearest = std::ranges::min_element(
        directions_, {}, [&](const Direction& direction) { return (direction.middle - middle).norm(); });
    if (nearest != directions_.end()) shape.along_rad = nearest->along_rad;
    art_.lines.push_back(std::move(shape));
  }

  // Points of the path close by each other, y up.
  std::vector<Vector2d> followed(const pugi::xml_node& node, const Geom::Path& path) {
    constexpr std::size_t kMostPoints = 20'000'000;
    std::vector<Vector2d> line;
    const auto add = [&](const Geom::Point& p) {
      if (!(std::abs(p.x()) < kFarthest_mm && std::abs(p.y()) < kFarthest_mm))
        fail_at(node, "lies more than 10 m from the origin; check the drawing's size");
      line.emplace_back(p.x(), -p.y());
    };
    add(path.initialPoint());
    for (std::size_t i = 0; i < path.size_default(); ++i) {
      const Geom::Curve& curve = path[i];
      double length_mm = 0;  // of a polygon, which no curve exceeds by much
      Geom::Point before = curve.initialPoint();
      for (int k = 1; k <= 16; ++k) {
        const Geom::Point next = curve.pointAt(k / 16.0);
        length_mm += Geom::distance(before, next), before = next;
      }
      const double wanted = std::ceil(length_mm / renderer::kLineStep_mm);
      if (!(wanted < 1e6)) fail_at(node, "has a line of more than 100 m; check the drawing's size");
      const int parts = std::max(1, static_cast<int>(wanted));
      if ((followed_ += static_cast<std::size_t>(parts)) > kMostPoints)
        fail("has more than 2 km of lines; make it smaller, or its lines fewer");
      if (length_mm > 0)
        for (int k = 1; k <= parts; ++k) add(curve.pointAt(static_cast<double>(k) / parts));
    }
    line.erase(std::unique(line.begin(), line.end()), line.end());
    return line;
  }

  std::string source_;
  renderer::LineArt art_;
  std::map<std::string, Style> rules_;
  std::vector<Direction> directions_;  // those of the group that is walked
  std::size_t followed_ = 0;
};

}  // namespace

renderer::LineArt parse_svg(std::string_view text, const std::string& source) {
  return SvgReader(source).read(text);
}

}  // namespace station
