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

}  // namespace station
