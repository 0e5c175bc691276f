// Pieces of a self-contained HTML page: escaped text, embedded pictures, tables. Opens offline, runs no script.
#pragma once

#include <initializer_list>
#include <opencv2/core.hpp>
#include <string>
#include <utility>
#include <vector>

namespace station {

std::string escaped(const std::string& text);
// <img> with the picture embedded as PNG.
std::string embedded_image(const cv::Mat3b& rgb, const std::string& description);
// Two-column table of names and values.
std::string fact_table(const std::vector<std::pair<std::string, std::string>>& facts);
// The whole page with the house style.
std::string html_page(const std::string& title, const std::string& body);
std::string number_text(double value, int decimals);
std::string percent_text(double part);  // "12.3 %"
// "0.1, 0.2, 0.3"
std::string numbers_text(std::initializer_list<double> values, int decimals);

}  // namespace station
