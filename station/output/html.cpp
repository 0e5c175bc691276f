#include "station/output/html.h"

#include <openssl/evp.h>

#include "renderer/picture/image_file.h"

namespace station {
namespace {

std::string base64(const std::string& bytes) {
  std::string text(4 * ((bytes.size() + 2) / 3) + 1, '\0');
  const int length =
      EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()),
                      reinterpret_cast<const unsigned char*>(bytes.data()), static_cast<int>(bytes.size()));
  text.resize(static_cast<std::size_t>(length));
  return text;
}

constexpr const char* kStyle =
    "body{font:15px/1.45 system-ui,sans-serif;margin:2rem auto;max-width:1180px;padding:0 "
    "1rem;color:#1c1c1c;background:#fafafa}"
    "h1{font-size:1.6rem}h2{font-size:1.2rem;margin-top:2rem;border-bottom:1px solid #ccc}"
    ".sheet{display:grid;grid-template-columns:repeat(auto-fill,minmax(260px,1fr));gap:12px}"
    "figure{margin:0;background:#fff;border:1px solid #ddd;padding:6px}figure "
    "img{width:100%;display:block;image-rendering:auto}"
    "figcaption{font-size:.8rem;padding-top:4px}"
    "table{border-collapse:collapse;background:#fff}td,th{border:1px solid #ddd;padding:3px 10px;text-align:left;"
    "font-variant-numeric:tabular-nums}th{background:#f0f0f0}";

}  // namespace

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string embedded_image(const cv::Mat3b& rgb, const std::string& description) {
  return "<img alt=\"" + escaped(description) + "\" src=\"data:image/png;base64," + base64(renderer::encode_png(rgb)) +
         "\">";
}

std::string fact_table(const std::vector<std::pair<std::string, std::string>>& facts) {
  std::string rows;
  for (const auto& [name, value] : facts)
    rows += "<tr><th>" + escaped(name) + "</th><td>" + escaped(value) + "</td></tr>\n";
  return "<table>\n" + rows + "</table>\n";
}

std::string html_page(const std::string& title, const std::string& body) {
  return "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
         "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">"
         "<link rel=\"icon\" href=\"data:,\"><title>" +
         escaped(title) + "</title><style>" + kStyle + "</style></head>\n<body>\n<h1>" + escaped(title) + "</h1>\n" +
         body + "</body></html>\n";
}

}  // namespace station
