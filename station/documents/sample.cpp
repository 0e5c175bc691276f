#include "station/documents/sample.h"

namespace station {

nlohmann::json to_json(const Sample& sample) {
  return {{"barcode", sample.barcode},   {"name", sample.name},     {"lot", sample.lot},
          {"material", sample.material}, {"colour", sample.colour}, {"note", sample.note}};
}

Sample read_sample(ObjectReader& reader) {
  Sample sample{.barcode = reader.text("barcode"),
                .name = reader.text("name"),
                .lot = reader.text("lot"),
                .material = reader.text("material"),
                .colour = reader.text("colour"),
                .note = reader.text("note")};
  reader.finish();
  return sample;
}

Sample read_sample_file(const std::filesystem::path& file) {
  const nlohmann::json document = read_json_file(file);
  ObjectReader reader(document, file.string(), "sample");
  return read_sample(reader);
}

void write_sample_file(const std::filesystem::path& file, const Sample& sample) {
  nlohmann::json document = to_json(sample);
  document.update({{"format", "threadstation/sample"}, {"version", 1}});
  write_json_file(file, document);
}

}  // namespace station
