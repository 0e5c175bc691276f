#include "station/bench/set_up/rig_interview.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <vector>

#include "rig/devices/detect.h"
#include "station/data/data_folder.h"
#include "station/documents/number_text.h"
#include "station/documents/range.h"

namespace station {
namespace {

using nlohmann::json;

constexpr const char* kNetwork = "ptpip:";
constexpr const char* kEnd = ", or q and Enter to end: ";
const rig::Choice kDeclined{rig::kDecline, "q", "End, and go on another time"};

// A number of the rig file, or several.
struct Measure {
  const char* key;  // a JSON pointer
  std::size_t numbers;
  Range range;
  const char* question;
  const char* drawing;  // station/handbook/drawings
};

constexpr Measure kMeasures[] = {
    {"/control_bar_mm",
     1,
     {80, 125},
     "Print the targets (\"threadstation target\") at 100 %, not fitted to the page. Measure the control bar on the "
     "print with a steel rule, to a fifth of a millimetre: how long is it, in mm? It is drawn 100 mm long.",
     "control_bar"},
    {"/platform/height_mm", 1, {1, 500}, "How high is the top of the platform above the table, in mm?", "platform"},
    {"/platform/radius_mm", 1, {10, 2000}, "How far is the platform's rim from its axis, in mm?", "platform"},
    {"/lamp_by_tape/front_position_mm",
     3,
     {-5000, 5000},
     "Where does the lamp in front stand? From the platform's axis: towards the camera, to the right as the camera "
     "sees it, and up from the table, in mm.",
     "lamp_front"},
    {"/lamp_by_tape/back_position_mm",
     3,
     {-5000, 5000},
     "And the lamp behind the spool? The first number is below 0, because it stands beyond the axis.",
     "lamp_back"},
    {"/lamp_by_tape/radius_mm", 1, {0.1, 100}, "What is half the width of the lamp's bright face, in mm?", "lamp_face"},
    {"/spectralon/albedo",
     1,
     {0.5, 1},
     "What does the certificate of the white panel say of its reflectance? 0.99 for Spectralon of 99 %.",
     "panel"},
    {"/reference_patch/albedo",
     1,
     {0.01, 1},
     "And what is said of the reflectance of the two grey chips that lie on the frame? 0.4 for chips of 40 %.",
     "holder"},
    {"/colour_chart/patch_mm",
     1,
     {2, 60},
     "How wide is one square of the colour chart, measured on the chart itself, in mm?",
     "chart"},
    {"/colour_chart/pitch_mm",
     1,
     {2, 60},
     "And how far is it from the middle of one square to the middle of the next, in mm? Measure over five squares.",
     "chart"},
};

struct Name {
  const char* key;
  const char* question;
};

constexpr Name kNames[] = {
    {"/name", "What is this bench called?"},
    {"/camera_setup/lens", "What is written on the lens?"},
    {"/camera_setup/focus", "How is its focus kept, so that another day finds it again?"},
};

std::string shown(const RigDraft& value) {
  if (value.is_string()) return value.get<std::string>();
  if (!value.is_array()) return value.dump();
  std::string all;
  for (const RigDraft& number : value) all += (all.empty() ? "" : " ") + number.dump();
  return all;
}

void show(rig::AskedPerson& asked, const std::string& drawing) {
  const std::string file = (data_folder_name() / "handbook/drawings" / (drawing + ".svg")).string();
  asked.prepare({{"drawing", drawing}}, drawing.empty() ? "" : "Drawing: " + file + "\n");
}

// What is typed, or nothing to keep what is there.
std::optional<std::string> ask_text(rig::AskedPerson& asked, const std::string& question, const std::string& now,
                                    const std::string& typed, const std::string& remark) {
  const std::string answer =
      ask_or_end(asked, {.text = question,
                         .how = "Now: " + now + ". Type another and press Enter, Enter alone to keep it" + kEnd,
                         .choices = {{rig::kDone, "", "Keep what is there: " + now}, kDeclined},
                         .typed = typed,
                         .remark = remark});
  return answer == rig::kDone ? std::nullopt : std::optional(answer);
}

// The numbers of a text, between which are spaces or semicolons, or commas where a comma is no decimal point. Nothing
// when it holds anything else.
std::optional<std::vector<double>> numbers_in(std::string text, std::size_t count) {
  const auto commas = static_cast<std::size_t>(std::ranges::count(text, ','));
  const bool separates = count > 1 && (commas == count - 1) &&
                         (text.find(' ') == std::string::npos || text.find(", ") != std::string::npos);
  for (char& c : text)
    if (c == ';' || (c == ',' && separates))
      c = ' ';
    else if (c == ',')
      c = '.';
  std::istringstream words(text);
  words.imbue(std::locale::classic());
  std::vector<double> numbers;
  for (double number = 0; words >> number;) numbers.push_back(number);
  words.clear();
  std::string rest;
  if (words >> rest || numbers.size() != count) return std::nullopt;
  return numbers;
}

std::string range_text(Range range) {
  return number_text(range.low, 2) + " to " + number_text(range.high, 2);
}

void ask_measure(const Measure& measure, RigDraft& draft, rig::AskedPerson& asked) {
  RigDraft& value = draft[RigDraft::json_pointer(measure.key)];
  const std::string count = measure.numbers == 1 ? "a number" : std::to_string(measure.numbers) + " numbers";
  show(asked, measure.drawing);
  for (std::string remark;;) {
    const auto typed = ask_text(asked, measure.question, shown(value), count, remark);
    if (!typed) return;
    const auto numbers = numbers_in(*typed, measure.numbers);
    const auto fits = [&](double number) { return number >= measure.range.low && number <= measure.range.high; };
    if (numbers && std::ranges::all_of(*numbers, fits)) {
      if (measure.numbers == 1)
        value = numbers->front();
      else
        value = *numbers;
      return;
    }
    remark = "\"" + *typed + "\" cannot be taken: expected " + count + " from " + range_text(measure.range) +
             ", for example " + shown(value) + ".";
  }
}

// The port of the one device that is there, or that the person chooses.
rig::FoundDevice ask_for_device(rig::AskedPerson& asked, std::vector<rig::FoundDevice> (*find)(),
                                const std::string& what, const std::string& when_missing) {
  show(asked, "");
  for (;;) {
    const std::vector<rig::FoundDevice> found = find();
    if (found.size() == 1) return found.front();
    rig::Question question{.text = found.empty() ? when_missing : "Which of these is the " + what + "?", .choices = {}};
    question.how = found.empty() ? "Press Enter to look again" : "Type its number and press Enter";
    question.how += kEnd;
    if (found.empty()) question.choices.push_back({"again", "", "Look again"});
    for (std::size_t i = 0; i < found.size(); ++i) {
      const std::string number = std::to_string(i + 1);
      question.choices.push_back({number, number, found[i].name + " (" + found[i].believed_to_be + ")"});
      question.text += "\n  " + number + "  " + question.choices.back().label;
    }
    question.choices.push_back(kDeclined);
    const std::string answer = ask_or_end(asked, question);
    if (answer != "again") return found.at(std::stoul(answer) - 1);
  }
}

}  // namespace

std::string ask_for_ready_rig(rig::AskedPerson& asked) {
  rig::Question question{.text = "What turns the platform?",
                         .how = std::string("Type a number and press Enter") + kEnd,
                         .choices = {{"grbl_sony_usb", "1", "A stepper motor with a GRBL controller"},
                                     {"zaber_sony_usb", "2", "A Zaber rotary stage"},
                                     {"manual_sony_usb", "3", "A person, by hand"},
                                     {"simulated", "4", "Nothing: this is to practise on a simulated bench"}}};
  for (const rig::Choice& choice : question.choices) question.text += "\n  " + choice.key + "  " + choice.label;
  question.choices.push_back(kDeclined);
  return ask_or_end(asked, question);
}

void ask_for_ports(RigDraft& draft, rig::AskedPerson& asked) {
  const std::string now = draft.contains("camera_connection") ? shown(draft["camera_connection"]["port"]) : "simulated";
  if (now.starts_with(kNetwork)) {  // cannot be found by looking
    if (const auto typed = ask_text(asked, "At which address of the network does the camera answer?", now,
                                    "an address such as ptpip:192.168.1.40", ""))
      draft["camera_connection"]["port"] = (typed->starts_with(kNetwork) ? "" : kNetwork) + *typed;
  } else if (now != "simulated") {
    const rig::FoundDevice camera =
        ask_for_device(asked, rig::find_cameras, "camera",
                       "No camera is found. Plug it in by USB, switch it on, and set its USB connection to PC Remote "
                       "(or PTP).");
    draft["camera_connection"]["port"] = rig::find_cameras().size() > 1 ? camera.port : "usb:";
  }
  if (draft.contains("turntable_setup") && draft["turntable_setup"]["line"] == "serial") {
    const rig::FoundDevice port =
        ask_for_device(asked, rig::find_serial_ports, "turntable",
                       "No serial port is found. Plug the turntable's USB cable in and switch its power on.");
    RigDraft& setup = draft["turntable_setup"];
    setup.erase("usb_serial");
    setup["port"] = port.recommended.empty() ? port.port : port.recommended;
  }
}

void ask_for_measures(RigDraft& draft, rig::AskedPerson& asked, const std::function<void()>& keep) {
  show(asked, "");
  for (const Name& name : kNames) {
    RigDraft& value = draft[RigDraft::json_pointer(name.key)];
    if (const auto typed = ask_text(asked, name.question, shown(value), "a name", "")) value = *typed;
    keep();
  }
  for (const Measure& measure : kMeasures) {
    if (!draft.contains(RigDraft::json_pointer(measure.key))) continue;  // the bench has no such part
    ask_measure(measure, draft, asked);
    keep();
  }
  asked.prepare({{"drawing", nullptr}}, "");
}

}  // namespace station
