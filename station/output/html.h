// Pieces of a self-contained HTML page, which opens offline and runs no script: escaped text, embedded pictures,
// tables.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <utility>
#include <vector>

namespace station {

std::string escaped(const std::string& text);
// An <img> element with the picture embedded as PNG.
std::string embedded_image(const cv::Mat3b& rgb, const std::string& description);
// A two-column table of names and values.
std::string fact_table(const std::vector<std::pair<std::string, std::string>>& facts);
// The whole page, in the one style of all our pages.
std::string html_page(const std::string& title, const std::string& body);

}  // namespace station
