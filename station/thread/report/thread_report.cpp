#include "station/thread/report/thread_report.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <set>

#include "renderer/picture/image_file.h"
#include "station/documents/number_text.h"
#include "station/documents/reader.h"
#include "station/documents/thread_file.h"
#include "station/output/display.h"
#include "station/output/html.h"
#include "station/output/plot.h"
#include "station/session/results.h"
#include "station/session/shown_cloth.h"
#include "station/thread/invert/fit_document.h"
#include "station/thread/report/fitted_twins.h"

namespace station {
namespace {

std::string parameter_table(const ThreadFile& thread) {
  const renderer::ThreadParameters& p = thread.parameters;
  return fact_table(
      {{"agreement with the photographs",
        number_text(100 * thread.fit.at("relative_rmse").get<double>(), 1) + " % relative RMSE over blocks of " +
            std::to_string(thread.fit.at("block_px").get<int>()) + " px, all fitted views alike"},
       {"absorption sigma_a (R, G, B)",
        numbers_text({p.sigma_a[0], p.sigma_a[1], p.sigma_a[2]}, 3) + " per thread radius"},
       {"longitudinal roughness alpha (R, TT, TRT)", numbers_text({p.alpha[0], p.alpha[1], p.alpha[2]}, 3)},
       {"azimuthal roughness beta (R, TT, TRT)", numbers_text({p.beta[0], p.beta[1], p.beta[2]}, 3)},
       {"r0", numbers_text({p.r0a, p.r0b, p.r0c}, 3)},
       {"r1", number_text(p.r1a, 3)},
       {"r2", numbers_text({p.r2a, p.r2b, p.r2c}, 3)},
       {"thread diameter", number_text(thread.diameter_mm, 3) + " mm"}});
}

std::string energy_plot(const renderer::ThreadParameters& parameters) {
  constexpr int kSteps = 100;
  std::vector<PlotLine> lines{{"R: lambda_0", {}}, {"TT: lambda_1", {}}, {"TRT: lambda_2", {}}, {"sum", {}}};
  for (int i = 0; i <= kSteps; ++i) {
    const double c = static_cast<double>(i) / kSteps;
    const auto lambda = renderer::thread_lobe_energies<double>(parameters, c);
    for (std::size_t p = 0; p < 3; ++p) lines[p].points.emplace_back(c, lambda[p]);
    lines[3].points.emplace_back(c, lambda[0] + lambda[1] + lambda[2]);
  }
  return line_plot("cos theta", "scale factor", lines);
}

// A model that was fitted to the session, with the report of its fit.
struct FittedModel {
  std::string name;
  nlohmann::json fit;
};

// The thread first, then the baselines that were fitted as well.
std::vector<FittedModel> fitted_models(const std::filesystem::path& session, const ThreadFile& thread) {
  std::vector<FittedModel> models{{"thread", thread.fit}};
  for (const auto& [name, kind] : names_of_models())
    if (kind != inversion::ModelKind::thread && std::filesystem::exists(baseline_fit_of(session, name)))
      models.push_back({name, read_json_file(baseline_fit_of(session, name))});
  return models;
}

std::set<std::string> held_out_of(const FittedModel& model) {
  std::set<std::string> ids;
  for (const nlohmann::json& view : model.fit.at("views"))
    if (view.value("held_out", false)) ids.insert(view.at("id"));
  return ids;
}

// The models side by side; empty for a thread alone of which no view was held out.
std::string model_table(const std::vector<FittedModel>& models) {
  const std::set<std::string> held_out = held_out_of(models.front());
  if (models.size() == 1 && held_out.empty()) return {};
  std::string table =
      "<h2>Models on the same views</h2>\n<table>\n<tr><th>relative RMSE</th><th>all fitted views</th>"
      "<th>reflection</th><th>transmission</th><th>held-out views</th></tr>\n";
  std::string differing;
  for (const FittedModel& model : models) {
    table += "<tr><th>" + shown_model(model.name) + "</th>";
    for (const char* key :
         {"relative_rmse", "relative_rmse_reflection", "relative_rmse_transmission", "relative_rmse_held_out"}) {
      const auto found = model.fit.find(key);
      table += "<td>" +
               (found == model.fit.end() ? std::string("none") : number_text(100 * found->get<double>(), 1) + " %") +
               "</td>";
    }
    table += "</tr>\n";
    if (held_out_of(model) != held_out)
      differing += "<p class=\"doubt\">The " + shown_model(model.name) +
                   " was fitted with other views held out than the thread: fit both with the same --hold-out to "
                   "compare them.</p>\n";
  }
  return table + "</table>\n" + differing;
}

std::string figures_of(const FittedModel& model, const std::string& id) {
  for (const nlohmann::json& view : model.fit.at("views"))
    if (view.at("id") == id)
      return std::string(view.value("held_out", false) ? "held out: " : "") + "relative RMSE " +
             number_text(100 * view.at("relative_rmse").get<double>(), 1) + " %, bias " +
             number_text(100 * view.at("relative_bias").get<double>(), 1) + " %";
  return "not fitted";
}

// The photograph of a view, then each model's twin above its residual.
std::string view_figures(const std::filesystem::path& session, const DevelopedView& developed,
                         const std::vector<FittedModel>& models, const std::array<double, 9>& colour) {
  const inversion::View& view = developed.view;
  std::string figures;
  for (const FittedModel& model : models) {
    // A baseline may have been fitted before the session was developed again with other views.
    if (model.name != "thread" && !std::filesystem::exists(fitted_file_of(session, view.id, model.name))) {
      figures += "<figure><figcaption>" + shown_model(model.name) + ": not fitted to this view</figcaption></figure>\n";
      continue;
    }
    const FittedTwins twins = read_twins(session, view, model.name);
    const auto shown = [&](const cv::Mat3f& picture, const std::string& what) {
      return embedded_image(display(picture, twins.exposure, colour)(twins.box).clone(), view.id + " " + what);
    };
    if (figures.empty())
      figures = "<figure>" + shown(twins.photographed, "photographed") + "<figcaption>" + escaped(view.id) +
                ": photographed<br>" + describe(twins.exposure) + "</figcaption></figure>\n";
    figures += "<figure>" + shown(twins.fitted, model.name) +
               shown(residual_picture(view, twins, model.fit.at("block_px").get<int>()), model.name + " residual") +
               "<figcaption>" + shown_model(model.name) + ", and minus photographed (grey is none)<br>" +
               figures_of(model, view.id) + "</figcaption></figure>\n";
  }
  return figures;
}

cv::Mat3b fitted_into(const cv::Mat3b& picture, cv::Size size) {
  const double scale =
      std::min(static_cast<double>(size.width) / picture.cols, static_cast<double>(size.height) / picture.rows);
  cv::Mat3b small;
  cv::resize(picture, small, {cvRound(scale * picture.cols), cvRound(scale * picture.rows)}, 0, 0, cv::INTER_AREA);
  cv::Mat3b tile(size, cv::Vec3b(255, 255, 255));
  small.copyTo(tile(cv::Rect((size.width - small.cols) / 2, (size.height - small.rows) / 2, small.cols, small.rows)));
  return tile;
}

}  // namespace

std::string thread_section(const std::filesystem::path& session, const DevelopedViews& developed) {
  if (!std::filesystem::exists(thread_file_of(session))) return {};
  const ThreadFile thread = read_thread(thread_file_of(session));
  std::string doubts;
  if (const auto found = thread.fit.find("doubts"); found != thread.fit.end())
    for (const nlohmann::json& doubt : *found)
      doubts += "<p class=\"doubt\">Doubt: " + escaped(doubt.get<std::string>()) + "</p>\n";
  const std::vector<FittedModel> models = fitted_models(session, thread);
  const std::string open = "<div class=\"sheet\">\n", close = "</div>\n";
  const std::string between = models.size() > 1 ? close + open : std::string();  // a row for each view
  std::string html = "<h2>Thread</h2>\n" + doubts + parameter_table(thread) + energy_plot(thread.parameters) + "\n" +
                     model_table(models) + "<h2>Photographs and their fitted twins</h2>\n" + open;
  for (const DevelopedView& view : developed.views)
    html += view_figures(session, view, models, developed.linear_srgb_from_camera) + between;
  return html + close;
}

std::string cloth_section(const std::filesystem::path& session, const DevelopedViews& developed) {
  std::string html;
  for (const std::filesystem::path& file : cloth_pictures(session))
    html += "<figure>" + embedded_image(shown_cloth(file, 0, developed.linear_srgb_from_camera), file.stem().string()) +
            "<figcaption>" + escaped(file.stem().string()) + "</figcaption></figure>\n";
  return html.empty() ? html : "<h2>Predicted cloth</h2>\n<div class=\"sheet\">\n" + html + "</div>\n";
}

std::vector<std::string> fitted_model_names(const std::filesystem::path& session) {
  std::vector<std::string> names;
  if (!std::filesystem::exists(thread_file_of(session))) return names;
  for (const FittedModel& model : fitted_models(session, read_thread(thread_file_of(session))))
    names.push_back(model.name);
  return names;
}

cv::Mat3b models_picture(const std::filesystem::path& session, const DevelopedViews& developed) {
  const cv::Size kTile(180, 120);
  constexpr int kGap_px = 8;
  constexpr std::size_t kViewsPerRow = 6;
  const std::vector<std::string> models = fitted_model_names(session);
  if (models.empty()) return {};
  const auto tiles = static_cast<int>(models.size() + 1), views = static_cast<int>(developed.views.size()),
             per_row = static_cast<int>(kViewsPerRow), rows = (views + per_row - 1) / per_row;
  const int row_px = tiles * kTile.height + kGap_px;
  cv::Mat3b sheet(rows * row_px - kGap_px, std::min(views, per_row) * kTile.width, cv::Vec3b(255, 255, 255));
  for (int i = 0; i < views; ++i) {
    const inversion::View& view = developed.views[static_cast<std::size_t>(i)].view;
    const int left = i % per_row * kTile.width, top = i / per_row * row_px, stops = exposure_of(view).stops;
    const auto place = [&](const cv::Mat3f& picture, const FittedTwins& twins, int row) {
      fitted_into(display(picture, twins.exposure, developed.linear_srgb_from_camera)(twins.box), kTile)
          .copyTo(sheet(cv::Rect({left, top + row * kTile.height}, kTile)));
    };
    for (int row = 1; row < tiles; ++row) {
      const std::string& model = models[static_cast<std::size_t>(row - 1)];
      if (!std::filesystem::exists(fitted_file_of(session, view.id, model))) continue;  // fitted to other views
      const FittedTwins twins = read_twins(session, view, model, stops);
      place(twins.photographed, twins, 0);
      place(twins.fitted, twins, row);
    }
  }
  return sheet;
}

cv::Mat3b overview_picture(const std::filesystem::path& session, const DevelopedViews& developed) {
  const auto cloths = cloth_pictures(session);
  if (cloths.empty() || !std::filesystem::exists(thread_file_of(session))) return {};
  constexpr int kShown = 6, kTile_px = 111, kTileHeight_px = 74;
  cv::Mat3b left;
  for (std::size_t i = 0; i < developed.views.size(); i += std::max<std::size_t>(1, developed.views.size() / kShown)) {
    const FittedTwins twins = read_twins(session, developed.views[i].view);
    const auto tile = [&](const cv::Mat3f& picture) {
      return fitted_into(display(picture, twins.exposure, developed.linear_srgb_from_camera)(twins.box),
                         {kTile_px, kTileHeight_px});
    };
    cv::Mat3b row;
    cv::hconcat(tile(twins.photographed), tile(twins.fitted), row);
    if (left.empty())
      left = row;
    else
      cv::vconcat(left, row, left);
  }
  cv::Mat3b sheet = left;
  for (const std::filesystem::path& file : cloths) {
    const cv::Mat3b cloth = shown_cloth(file, 0, developed.linear_srgb_from_camera);
    cv::hconcat(sheet, fitted_into(cloth, {left.rows * cloth.cols / cloth.rows, left.rows}), sheet);
  }
  return sheet;
}

}  // namespace station
