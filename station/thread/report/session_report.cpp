#include "station/thread/report/session_report.h"

#include <map>
#include <optional>

#include "renderer/picture/image_file.h"
#include "station/bench/calibrate/calibration_report.h"
#include "station/documents/calibration_file.h"
#include "station/documents/degree.h"
#include "station/documents/disk/stored_file.h"
#include "station/documents/manifest.h"
#include "station/documents/number_text.h"
#include "station/documents/reader.h"
#include "station/documents/session_file.h"
#include "station/documents/views_file.h"
#include "station/output/display.h"
#include "station/output/html.h"
#include "station/session/record/picture_record.h"
#include "station/thread/report/capture_report.h"
#include "station/thread/report/contact_sheet.h"
#include "station/thread/report/fitted_twins.h"
#include "station/thread/report/thread_report.h"

namespace station {
namespace {

using Pictures = std::map<std::string, PictureRecord>;

// A view's verdict; a good one has no reasons.
std::string verdict_text(const DevelopedView& developed, const Pictures& pictures) {
  const auto picture = pictures.find(developed.view.id);
  if (picture == pictures.end()) return "";
  const Verdict& verdict = picture->second.verdict;
  const std::string grade = grade_name(verdict.grade());
  return " <span class=\"" + grade + "\">" + grade + "</span>" +
         (verdict.reason().empty() ? "" : " " + escaped(verdict.reason()));
}

std::string caption(const DevelopedView& developed, const Pictures& pictures) {
  return escaped(developed.view.id) + verdict_text(developed, pictures) + "<br>" +
         number_text(developed.platform_angle_rad / kDegree, 2) + "&deg;, exposure " +
         number_text(developed.exposure_s, 4) + " s, " + std::to_string(developed.masked_pixels) +
         " masked pixels, saturated " + number_text(100 * developed.saturated_fraction, 2) + " %";
}

// One tile: the developed picture and, under it, the same with the mask's outline.
std::string tile(const DevelopedView& developed, const Pictures& pictures, const std::array<double, 9>& colour) {
  const Exposure exposure = exposure_of(developed.view);
  const cv::Rect box = threads_box(developed.view.mask);
  const cv::Mat3b picture = display(developed.view.image, exposure, colour);
  cv::Mat3b outlined = picture.clone();
  draw_outline(outlined, developed.view.mask);
  return "<figure>" + embedded_image(picture(box).clone(), developed.view.id) +
         embedded_image(outlined(box).clone(), developed.view.id + " with its mask") + "<figcaption>" +
         caption(developed, pictures) + "<br>" + describe(exposure) + "</figcaption></figure>\n";
}

std::string view_tiles(const DevelopedViews& developed, const Pictures& pictures, bool transmission) {
  std::string tiles;
  int count = 0;
  for (const DevelopedView& view : developed.views)
    if (view.view.transmission == transmission) {
      tiles += tile(view, pictures, developed.linear_srgb_from_camera);
      ++count;
    }
  if (count == 0) return {};
  return "<h2>" + std::string(transmission ? "Transmission" : "Reflection") + ", " + std::to_string(count) +
         " views</h2>\n<div class=\"sheet\">\n" + tiles + "</div>\n";
}

}  // namespace

std::filesystem::path write_session_report(const std::filesystem::path& session) {
  const SessionFile asked = read_session_file(session);
  std::optional<RigCalibration> calibration;
  if (!asked.measured) calibration = read_calibration(session / "calibration");
  std::string body = capture_facts(session, asked, calibration ? &*calibration : nullptr);
  if (std::filesystem::exists(session / "linear" / "views.json")) {
    make_folder(session / "result");
    DevelopedViews developed = read_views(session);
    read_view_pictures(session, developed);
    body += cloth_section(session, developed) + thread_section(session, developed);
    const Pictures pictures = taken_pictures(read_journal(session / "journal.jsonl").records);
    body += view_tiles(developed, pictures, false) + view_tiles(developed, pictures, true);
    renderer::write_png(session / "result" / "contact_sheet.png", contact_sheet(developed));
    if (const cv::Mat3b models = models_picture(session, developed); !models.empty())
      renderer::write_png(session / "result" / "models.png", models);
    if (const cv::Mat3b overview = overview_picture(session, developed); !overview.empty())
      renderer::write_png(session / "result" / "overview.png", overview);
    FileSystem disk;
    write_manifest(session / "result", disk);
  } else {
    body += "<p>The views have not been developed yet: threadstation develop makes their pictures and masks.</p>\n";
  }
  body += verdict_section(session, asked);
  if (calibration) body += "<h2>Calibration</h2>\n" + calibration_section(*calibration);
  body += checksum_section(session);
  const std::filesystem::path file = session / "report.html";
  write_text_file(file, html_page("Thread session: " + asked.spool.name, body));
  return file;
}

}  // namespace station
