#include "rig/cameras/gphoto_camera.h"

#include <gphoto2/gphoto2.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <deque>
#include <optional>
#include <set>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "rig/cameras/make_settings.h"
#include "rig/devices/clock.h"

namespace rig {
namespace {

constexpr int kDrainMs = 50;
constexpr int kMostDrained = 50;         // events in a row; a camera that reports more is broken
constexpr std::size_t kRemembered = 64;  // pictures whose hash is kept
constexpr int kMostTries = 2;            // how often a picture is taken when an old one comes instead

using Context = std::unique_ptr<GPContext, void (*)(GPContext*)>;
using Handle = std::unique_ptr<::Camera, int (*)(::Camera*)>;
using Widget = std::unique_ptr<CameraWidget, int (*)(CameraWidget*)>;
using File = std::unique_ptr<CameraFile, int (*)(CameraFile*)>;

constexpr const char* kHeldByAnother =
    "another program holds the camera; close file manager windows that show it (or run: gio mount -s gphoto2) and try "
    "again";

std::string what_to_do(int status) {
  switch (status) {
    case GP_ERROR_IO_USB_CLAIM:
    case GP_ERROR_IO_LOCK:
      return kHeldByAnother;
    case GP_ERROR_MODEL_NOT_FOUND:
    case GP_ERROR_UNKNOWN_PORT:
    case GP_ERROR_IO_USB_FIND:
    case GP_ERROR_BAD_PARAMETERS:
      return "plug it in, switch it on, set a Sony's MENU > Setup > USB Connection to PC Remote, and check the "
             "camera's "
             "\"port\" in the rig file";
    case GP_ERROR_NOT_SUPPORTED:
      return "it cannot be done by a computer with this camera; take another one";
    case GP_ERROR_CAMERA_BUSY:
      return "it is busy; wait until its red light is off and try again";
    case GP_ERROR_NO_SPACE:
      return "its card is full; empty the card";
    case GP_ERROR_IO:
    case GP_ERROR_IO_READ:
    case GP_ERROR_IO_WRITE:
    case GP_ERROR_TIMEOUT:
      return "the connection is lost; check its cable and battery, switch it off and on, then resume";
    default:
      return "switch the camera off and on, then resume";
  }
}

// True for a broken connection, a missing answer or noise: none of them says what the camera did.
// GP_ERROR_BAD_PARAMETERS is among them because the library returns it when the camera's list of settings did not come.
bool is_lost(int status) {
  return status == GP_ERROR || status == GP_ERROR_IO || status == GP_ERROR_IO_READ || status == GP_ERROR_IO_WRITE ||
         status == GP_ERROR_TIMEOUT || status == GP_ERROR_BAD_PARAMETERS || status == GP_ERROR_CORRUPTED_DATA;
}

[[noreturn]] void refuse(const std::string& asked, int status) {
  const std::string message = "the camera was to " + asked + " and libgphoto2 answered \"" +
                              gp_result_as_string(status) + "\"; " + what_to_do(status);
  if (is_lost(status)) throw CameraLost(message);
  throw std::runtime_error(message);
}

void check(const std::string& asked, int status) {
  if (status < GP_OK) refuse(asked, status);
}

std::optional<double> number(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = error == std::errc{} && end == text.data() + text.size();
  return whole && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

// The shutter time that the text names ("1/125", "5/10", "30", "0.0080s"), in seconds; nothing for "Bulb".
std::optional<double> seconds_from(std::string_view text) {
  if (text.ends_with('s')) text.remove_suffix(1);
  const std::size_t slash = text.find('/');
  if (slash == std::string_view::npos) return number(text);
  const auto above = number(text.substr(0, slash)), below = number(text.substr(slash + 1));
  return above && below && *below > 0 ? std::optional(*above / *below) : std::nullopt;
}

// The f-number that the text names ("f/5.6").
std::optional<double> f_number_from(std::string_view text) {
  return number(text.starts_with("f/") ? text.substr(2) : text);
}

std::string listed(const std::vector<std::string>& texts) {
  std::string list;
  for (const std::string& text : texts) list += (list.empty() ? "" : ", ") + text;
  return list.empty() ? "nothing" : list;
}

// The part of a file's name after its last point, in small letters.
std::string extension_of(std::string_view name) {
  const std::size_t point = name.rfind('.');
  std::string extension(point == std::string_view::npos ? "" : name.substr(point + 1));
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

bool same_number(double a, double b) {
  return std::abs(a - b) <= 1e-6 * std::abs(b);
}

class GphotoCamera final : public Camera {
 public:
  explicit GphotoCamera(const GphotoSetup& setup)
      : setup_(setup), context_(gp_context_new(), gp_context_unref), handle_(nullptr, gp_camera_unref) {
    connect();
    learn_settings();
    require_manual_mode();
    require_battery();
    require_space();
    set_raw();
    set_if_offered("capturetarget", "Internal RAM");
    drain();
  }
  ~GphotoCamera() override { gp_camera_exit(handle_.get(), context_.get()); }
  GphotoCamera(const GphotoCamera&) = delete;
  GphotoCamera& operator=(const GphotoCamera&) = delete;

  CameraIdentity identity() override {
    return {.make = text_of("manufacturer"),
            .model = text_of("cameramodel"),
            .serial = text_of("serialnumber"),
            .width_px = setup_.width_px,
            .height_px = setup_.height_px};
  }

  std::vector<double> shutter_times_s() override {
    std::vector<double> times_s;
    for (const std::string& choice : choices_of(make_.shutter)) {
      const auto time_s = seconds_from(choice);
      if (time_s && *time_s >= setup_.shortest_shutter_s * (1 - 1e-6)) times_s.push_back(*time_s);
    }
    std::ranges::sort(times_s);
    times_s.erase(std::unique(times_s.begin(), times_s.end(), same_number), times_s.end());
    return times_s;
  }

  CameraSettings configure(const CameraSettings& wanted) override {
    const double exposure_s = nearest_shutter_s(shutter_times_s(), wanted.exposure_s);
    if (!std::isfinite(wanted.f_number) || wanted.f_number <= 0)
      throw std::runtime_error("f/" + std::to_string(wanted.f_number) + " was asked; it must be a positive number");
    choose(make_.iso, wanted.iso, number);
    f_number_asked_ = wanted.f_number;
    if (sets_aperture_) choose(make_.aperture, wanted.f_number, f_number_from);
    choose(make_.shutter, exposure_s, seconds_from);
    configured_ = settings();
    return *configured_;
  }

  Picture capture() override {
    if (!configured_) configured_ = settings();
    end_live_view();
    for (int tries = 0; tries < kMostTries; ++tries) {
      drain();
      Picture picture = take();
      require_kept_settings(picture.settings);
      if (remember(picture.bytes)) return picture;
    }
    throw std::runtime_error("the camera delivered a picture that it had delivered before, " +
                             std::to_string(kMostTries) +
                             " times; switch it off and on so that it forgets old ones, then resume");
  }

  std::vector<std::byte> preview() override {
    const File file = empty_file();
    const int status = gp_camera_capture_preview(handle_.get(), file.get(), context_.get());
    check("show what it sees", status);
    live_ = true;
    return bytes_of(file, "its live view");
  }

 private:
  void connect() {
    ::Camera* handle = nullptr;
    check("be prepared", gp_camera_new(&handle));
    handle_.reset(handle);
    choose_model();
    choose_port();
    const int status = gp_camera_init(handle_.get(), context_.get());
    if (status == GP_ERROR)  // on the network the library says no more than this
      throw CameraLost("the camera at " + setup_.port + " is there and turns the program away: " + kHeldByAnother);
    // The library answers GP_ERROR_FILE_NOT_FOUND when there is nothing at a USB address.
    check("be connected at " + setup_.port, status == GP_ERROR_FILE_NOT_FOUND ? GP_ERROR_IO_USB_FIND : status);
    // Some cameras answer properly only after this question.
    CameraText summary{};
    check("tell about itself", gp_camera_get_summary(handle_.get(), &summary, context_.get()));
  }

  // Over USB the library sees which camera it is; on the network it has to be told the driver.
  void choose_model() {
    if (!setup_.port.starts_with("ptpip:")) return;
    CameraAbilitiesList* list = nullptr;
    check("be prepared", gp_abilities_list_new(&list));
    const std::unique_ptr<CameraAbilitiesList, int (*)(CameraAbilitiesList*)> owner(list, gp_abilities_list_free);
    check("be prepared", gp_abilities_list_load(list, context_.get()));
    const int model = gp_abilities_list_lookup_model(list, "PTP/IP Camera");
    check("be prepared", model);
    CameraAbilities abilities{};
    check("be prepared", gp_abilities_list_get_abilities(list, model, &abilities));
    check("be prepared", gp_camera_set_abilities(handle_.get(), abilities));
  }

  void choose_port() {
    if (setup_.port == "usb:") return;  // the only one there is
    GPPortInfoList* list = nullptr;
    check("be prepared", gp_port_info_list_new(&list));
    const std::unique_ptr<GPPortInfoList, int (*)(GPPortInfoList*)> owner(list, gp_port_info_list_free);
    check("be prepared", gp_port_info_list_load(list));
    const int index = gp_port_info_list_lookup_path(list, setup_.port.c_str());
    check("be found at " + setup_.port, index);
    GPPortInfo info{};
    check("be found at " + setup_.port, gp_port_info_list_get_info(list, index, &info));
    check("be found at " + setup_.port, gp_camera_set_port_info(handle_.get(), info));
  }

  // The names of the settings that the camera has. Asked for any other, the library answers as if the connection were
  // broken.
  std::set<std::string> list_settings() const {
    CameraList* list = nullptr;
    check("list its settings", gp_list_new(&list));
    const std::unique_ptr<CameraList, int (*)(CameraList*)> owner(list, gp_list_free);
    check("list its settings", gp_camera_list_config(handle_.get(), list, context_.get()));
    std::set<std::string> names;
    for (int i = 0; i < gp_list_count(list); ++i) {
      const char* name = nullptr;
      check("list its settings", gp_list_get_name(list, i, &name));
      names.insert(name);
    }
    return names;
  }

  // A Canon tells its settings bit by bit, and an answer that was lost leaves some out: so they are listed twice before
  // one is called missing.
  void learn_settings() {
    std::string missing;
    for (int tries = 0; tries < 2; ++tries) {
      offered_ = list_settings();
      make_ = settings_of_make(text_of("manufacturer"), offered_);
      missing = missing_settings(make_, offered_);
      if (missing.empty()) break;
    }
    if (missing.empty()) {
      sets_aperture_ = can_be_read(make_.aperture) && has_aperture();
      return;
    }
    throw std::runtime_error("the camera was asked for its settings and has no " + missing +
                             " among them; set its dial to M and " + make_.connection +
                             ", switch it off and on, or take a camera that lets a computer set its exposure");
  }

  // False for a setting that the camera does not have, or has without choices: the library then makes nothing of it and
  // answers as if the connection were broken. So something else is asked that has to go over the connection, and the
  // setting once more.
  bool can_be_read(const std::string& name) const {
    for (int tries = 0; tries < 2 && offered_.contains(name); ++tries) {
      CameraWidget* found = nullptr;
      const int status = gp_camera_get_single_config(handle_.get(), name.c_str(), &found, context_.get());
      const Widget owner(found, gp_widget_free);
      if (status >= GP_OK) return true;
      if (status != GP_ERROR_BAD_PARAMETERS) refuse("tell its " + name, status);
      require_space();
    }
    return false;
  }

  // False for a lens without an electronic aperture, which reads 0 or has no number to choose.
  bool has_aperture() const {
    const auto is_number = [](const std::string& text) { return f_number_from(text).value_or(0) > 0; };
    return is_number(text_of(make_.aperture)) && std::ranges::any_of(choices_of(make_.aperture), is_number);
  }

  Widget widget(const std::string& name) const {
    CameraWidget* found = nullptr;
    const int status = gp_camera_get_single_config(handle_.get(), name.c_str(), &found, context_.get());
    check("tell its " + name, status);
    return {found, gp_widget_free};
  }

  std::string text_of(const std::string& name) const {
    const Widget found = widget(name);
    const char* text = nullptr;
    check("tell its " + name, gp_widget_get_value(found.get(), &text));
    return text == nullptr ? "" : text;
  }

  std::vector<std::string> choices_of(const std::string& name) const {
    const Widget found = widget(name);
    std::vector<std::string> choices;
    for (int i = 0; i < gp_widget_count_choices(found.get()); ++i) {
      const char* choice = nullptr;
      check("tell its " + name, gp_widget_get_choice(found.get(), i, &choice));
      choices.emplace_back(choice);
    }
    return choices;
  }

  void set_text(const std::string& name, const std::string& value) const {
    const Widget found = widget(name);
    check("set its " + name + " to " + value, gp_widget_set_value(found.get(), value.c_str()));
    const int status = gp_camera_set_single_config(handle_.get(), name.c_str(), found.get(), context_.get());
    check("set its " + name + " to " + value, status);
  }

  // Sets the choice whose number is nearest to the wanted one in proportion, and reads it back, because the camera does
  // not always do what it accepts.
  template <typename Parse>
  void choose(const std::string& name, double wanted, const Parse& parse) const {
    std::string best;
    double least = 1e9;
    for (const std::string& choice : choices_of(name)) {
      const auto value = parse(choice);
      if (value && *value > 0 && std::abs(std::log2(*value / wanted)) < least) {
        least = std::abs(std::log2(*value / wanted));
        best = choice;
      }
    }
    if (best.empty() || (name == make_.iso && least > 1e-6)) {
      throw std::runtime_error("the camera was to set its " + name + " to " + std::to_string(wanted) +
                               " and does not offer it; set its dial to M and switch ISO AUTO off");
    }
    const double chosen = *parse(best);
    if (const auto now = parse(text_of(name)); now && same_number(*now, chosen)) return;
    set_text(name, best);
    const std::string found = text_of(name);
    if (const auto now = parse(found); !now || !same_number(*now, chosen)) {
      throw std::runtime_error("the camera was to set its " + name + " to " + best + " and stays at " + found +
                               "; set its dial to M (and the lens's ring to A), then try again");
    }
  }

  CameraSettings settings() const {
    const auto exposure_s = seconds_from(text_of(make_.shutter));
    const auto iso = number(text_of(make_.iso));
    const auto aperture = sets_aperture_ ? f_number_from(text_of(make_.aperture)) : std::optional(f_number_asked_);
    if (!exposure_s || !iso || !aperture) {
      throw std::runtime_error("the camera was asked for its exposure and answered shutter " + text_of(make_.shutter) +
                               ", ISO " + text_of(make_.iso) + ", aperture " +
                               (aperture ? std::to_string(*aperture) : text_of(make_.aperture)) +
                               "; set its dial to M, switch ISO AUTO off, and check the lens");
    }
    return {.exposure_s = *exposure_s, .iso = static_cast<int>(std::lround(*iso)), .f_number = *aperture};
  }

  void require(const RequiredSetting& wanted) const {
    const std::string found = text_of(wanted.name);
    if (std::ranges::find(wanted.values, found) != wanted.values.end()) return;
    throw std::runtime_error("the camera's " + wanted.name + " is \"" + found + "\" and has to be \"" +
                             wanted.values.front() + "\"; set " + wanted.where);
  }

  void require_manual_mode() const {
    require(make_.mode);
    require(make_.focus);
    for (const RequiredSetting& automatic : make_.off)
      if (offered_.contains(automatic.name)) require(automatic);
  }

  void set_raw() const {
    const std::vector<std::string> choices = choices_of(make_.quality.name);
    const auto& raw = make_.quality.values;
    const auto found = std::ranges::find_first_of(choices, raw);
    if (found == choices.end()) {
      throw std::runtime_error("the camera was to deliver raw pictures and offers only " + listed(choices) +
                               "; take a camera that has raw pictures");
    }
    if (text_of(make_.quality.name) != *found) set_text(make_.quality.name, *found);
    require(make_.quality);
  }

  void set_if_offered(const std::string& name, const std::string& value) const {
    if (!offered_.contains(name) || text_of(name) == value) return;
    const std::vector<std::string> choices = choices_of(name);
    if (std::ranges::find(choices, value) != choices.end()) set_text(name, value);
  }

  // A mirror stays up, and a sensor grows warm, as long as the camera shows what it sees.
  void end_live_view() {
    if (live_ && offered_.contains("viewfinder")) {
      const Widget found = widget("viewfinder");
      const int off = 0;
      check("end its live view", gp_widget_set_value(found.get(), &off));
      const int status = gp_camera_set_single_config(handle_.get(), "viewfinder", found.get(), context_.get());
      check("end its live view", status);
    }
    live_ = false;
  }

  void require_battery() const {
    if (!offered_.contains("batterylevel")) return;  // on the mains
    std::string level = text_of("batterylevel");
    level = level.substr(0, level.find('%'));
    const auto percent = number(level);
    if (level == "Low" || (percent && *percent < setup_.least_battery_percent)) {
      throw std::runtime_error("the camera's battery is " + (percent ? "at " + level + " %" : "low") +
                               "; charge it, or use the mains adapter, then resume");
    }
  }

  void require_space() const {
    CameraStorageInformation* stores = nullptr;
    int count = 0;
    const int status = gp_camera_get_storageinfo(handle_.get(), &stores, &count, context_.get());
    if (status == GP_ERROR_NOT_SUPPORTED) return;
    check("tell about its card", status);
    const std::unique_ptr<CameraStorageInformation, void (*)(void*)> owner(stores, std::free);
    for (int i = 0; i < count; ++i)
      if ((stores[i].fields & GP_STORAGEINFO_FREESPACEKBYTES) != 0 && stores[i].freekbytes == 0)
        throw std::runtime_error("the camera's card is full; empty the card, then resume");
  }

  // Takes pictures that nobody asked for out of the camera: one that waits there would come in place of the next one.
  void drain() {
    for (int events = 0; events < kMostDrained; ++events) {
      CameraEventType type = GP_EVENT_UNKNOWN;
      void* data = nullptr;
      const int status = gp_camera_wait_for_event(handle_.get(), kDrainMs, &type, &data, context_.get());
      const std::unique_ptr<void, void (*)(void*)> owner(data, std::free);
      check("say whether old pictures wait in it", status);
      if (type == GP_EVENT_FILE_ADDED) {
        const auto* path = static_cast<const CameraFilePath*>(data);
        remember(download(*path));
      } else if (type == GP_EVENT_TIMEOUT) {
        return;
      }
    }
  }

  Picture take() {
    SystemClock clock;
    Picture picture;
    picture.utc = clock.utc();
    CameraFilePath path{};
    const int status = gp_camera_capture(handle_.get(), GP_CAPTURE_IMAGE, &path, context_.get());
    if (status < GP_OK) {
      require_battery();  // this message and the next say more than the library's
      require_space();
      refuse("take a picture", status);
    }
    picture.bytes = download(path);
    picture.extension = extension_of(path.name);
    picture.settings = settings();
    if (picture.bytes.empty() || !is_raw_extension(picture.extension)) {
      throw std::runtime_error("the camera was to deliver a raw picture and delivered \"" + std::string(path.name) +
                               "\" of " + std::to_string(picture.bytes.size()) + " bytes; set " + make_.quality.where +
                               ", then resume");
    }
    return picture;
  }

  static File empty_file() {
    CameraFile* made = nullptr;
    check("deliver a picture", gp_file_new(&made));
    return {made, gp_file_unref};
  }

  static std::vector<std::byte> bytes_of(const File& file, const std::string& name) {
    const char* data = nullptr;
    unsigned long size = 0;
    check("deliver " + name, gp_file_get_data_and_size(file.get(), &data, &size));
    const auto* bytes = reinterpret_cast<const std::byte*>(data);
    return {bytes, bytes + size};
  }

  std::vector<std::byte> download(const CameraFilePath& path) const {
    const File file = empty_file();
    const int status =
        gp_camera_file_get(handle_.get(), path.folder, path.name, GP_FILE_TYPE_NORMAL, file.get(), context_.get());
    check("deliver " + std::string(path.name), status);
    std::vector<std::byte> bytes = bytes_of(file, path.name);
    gp_camera_file_delete(handle_.get(), path.folder, path.name, context_.get());  // from the camera's memory
    return bytes;
  }

  void require_kept_settings(const CameraSettings& found) const {
    if (!same_number(found.exposure_s, configured_->exposure_s) || found.iso != configured_->iso ||
        !same_number(found.f_number, configured_->f_number)) {
      throw std::runtime_error("the camera's exposure was changed since it was set (shutter " +
                               std::to_string(found.exposure_s) + " s, ISO " + std::to_string(found.iso) + ", f/" +
                               std::to_string(found.f_number) + "); leave its dials alone, then resume");
    }
  }

  // False when the same bytes came before. Should two different pictures have one hash, one picture is taken again.
  bool remember(const std::vector<std::byte>& bytes) {
    const std::size_t hash = std::hash<std::string_view>{}({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    if (std::ranges::find(delivered_, hash) != delivered_.end()) return false;
    delivered_.push_back(hash);
    if (delivered_.size() > kRemembered) delivered_.pop_front();
    return true;
  }

  GphotoSetup setup_;
  Context context_;
  Handle handle_;
  std::set<std::string> offered_;  // names of settings
  MakeSettings make_;
  bool sets_aperture_ = false;  // the lens that is on the camera when it is connected
  bool live_ = false;           // it has shown what it sees since the last picture
  double f_number_asked_ = CameraSettings{}.f_number;
  std::optional<CameraSettings> configured_;
  std::deque<std::size_t> delivered_;
};

}  // namespace

std::unique_ptr<Camera> make_gphoto_camera(const GphotoSetup& setup) {
  return std::make_unique<GphotoCamera>(setup);
}

}  // namespace rig
