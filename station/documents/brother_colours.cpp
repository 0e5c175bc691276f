#include "station/documents/brother_colours.h"

namespace station {
namespace {

struct ChartEntry {
  const char* name;
  std::array<unsigned char, 3> srgb;
};

// clang-format off
constexpr std::array<ChartEntry, 64> kChart{{
    {"Prussian Blue", {{14, 31, 124}}}, {"Blue", {{10, 85, 163}}},
    {"Teal Green", {{0, 135, 119}}}, {"Cornflower Blue", {{75, 107, 175}}},
    {"Red", {{237, 23, 31}}}, {"Reddish Brown", {{209, 92, 0}}},
    {"Magenta", {{145, 54, 151}}}, {"Light Lilac", {{228, 154, 203}}},
    {"Lilac", {{145, 95, 172}}}, {"Mint Green", {{158, 214, 125}}},
    {"Deep Gold", {{232, 169, 0}}}, {"Orange", {{254, 186, 53}}},
    {"Yellow", {{255, 255, 0}}}, {"Lime Green", {{112, 188, 31}}},
    {"Brass", {{186, 152, 0}}}, {"Silver", {{168, 168, 168}}},
    {"Russet Brown", {{125, 111, 0}}}, {"Cream Brown", {{255, 255, 179}}},
    {"Pewter", {{79, 85, 86}}}, {"Black", {{0, 0, 0}}},
    {"Ultramarine", {{11, 61, 145}}}, {"Royal Purple", {{119, 1, 118}}},
    {"Dark Gray", {{41, 49, 51}}}, {"Dark Brown", {{42, 19, 1}}},
    {"Deep Rose", {{246, 74, 138}}}, {"Light Brown", {{178, 118, 36}}},
    {"Salmon Pink", {{252, 187, 197}}}, {"Vermilion", {{254, 55, 15}}},
    {"White", {{240, 240, 240}}}, {"Violet", {{106, 28, 138}}},
    {"Seacrest", {{168, 221, 196}}}, {"Sky Blue", {{37, 132, 187}}},
    {"Pumpkin", {{254, 179, 67}}}, {"Cream Yellow", {{255, 243, 107}}},
    {"Khaki", {{208, 166, 96}}}, {"Clay Brown", {{209, 84, 0}}},
    {"Leaf Green", {{102, 186, 73}}}, {"Peacock Blue", {{19, 74, 70}}},
    {"Gray", {{135, 135, 135}}}, {"Warm Gray", {{216, 204, 198}}},
    {"Dark Olive", {{67, 86, 7}}}, {"Flesh Pink", {{253, 217, 222}}},
    {"Pink", {{249, 147, 188}}}, {"Deep Green", {{0, 56, 34}}},
    {"Lavender", {{178, 175, 212}}}, {"Wisteria Violet", {{104, 106, 176}}},
    {"Beige", {{239, 227, 185}}}, {"Carmine", {{247, 56, 102}}},
    {"Amber Red", {{181, 75, 100}}}, {"Olive Green", {{19, 43, 26}}},
    {"Dark Fuchsia", {{199, 1, 86}}}, {"Tangerine", {{254, 158, 50}}},
    {"Light Blue", {{168, 222, 235}}}, {"Emerald Green", {{0, 103, 62}}},
    {"Purple", {{78, 41, 144}}}, {"Moss Green", {{47, 126, 32}}},
    {"Flesh Pink", {{255, 204, 204}}}, {"Harvest Gold", {{255, 217, 17}}},
    {"Electric Blue", {{9, 91, 166}}}, {"Lemon Yellow", {{240, 249, 112}}},
    {"Fresh Green", {{227, 243, 91}}}, {"Orange", {{255, 153, 0}}},
    {"Cream Yellow", {{255, 240, 141}}}, {"Applique", {{255, 200, 200}}},
}};
// clang-format on

}  // namespace

renderer::MotifThread brother_thread(int number) {
  if (number < 1 || number > static_cast<int>(kChart.size())) return {};
  const ChartEntry& entry = kChart[static_cast<std::size_t>(number - 1)];
  return {.name = entry.name, .srgb = entry.srgb};
}

}  // namespace station
