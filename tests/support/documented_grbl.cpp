#include "tests/support/documented_grbl.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>

#include "tests/support/documented_code.h"
#include "tests/support/documented_machine.h"
#include "tests/support/documented_settings.h"

namespace {

constexpr double kSliceS = 0.005;  // the board looks at its lines and its switch so often
constexpr std::size_t kPlannerBlocks = 15, kReceiveBytes = 128, kLineCharacters = 80;

// As GRBL keeps a line: without blanks and comments, in capitals.
std::string tidied(const std::string& line) {
  std::string kept;
  bool comment = false;
  for (const char c : line) {
    if (c == ';') break;
    comment = comment || c == '(';
    if (!comment && c > ' ') kept += c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    comment = comment && c != ')';
  }
  return kept;
}

}  // namespace

std::map<int, double> documented_turntable_settings() {
  return {{1, 255}, {22, 1}, {24, 90}, {25, 900}, {26, 25}, {100, 40}, {110, 1800}, {120, 150}, {130, 360}};
}

// The functions that others call take the lock and bring the board up to the clock's time; the private ones do neither.
class DocumentedGrbl::Board {
 public:
  Board(rig::Clock& clock, const DocumentedGrblOptions& options)
      : clock_(clock), options_(options), settings_(options.eeprom), machine_(options), now_s_(clock.monotonic_s()) {
    boot(0);
  }

  void open() {
    const std::lock_guard hold(mutex_);
    update();
    if (std::exchange(open_, true)) throw std::runtime_error("the documented board's port is open already");
    if (plugged_ && options_.resets_when_opened) boot(options_.boot_s);
  }
  void close() {
    const std::lock_guard hold(mutex_);
    open_ = false;
  }
  void plug(bool in) {
    const std::lock_guard hold(mutex_);
    update();
    plugged_ = in;
    if (in)
      boot(0);
    else
      halt();
  }

  std::string take() {
    const std::lock_guard hold(mutex_);
    require_plug();
    update();
    return std::exchange(said_, {});
  }
  void receive(std::string_view bytes) {
    const std::lock_guard hold(mutex_);
    require_plug();
    update();
    if (now_s_ < boots_until_s_) return;
    for (const char byte : bytes)
      if (!real_time(byte) && received_.size() < kReceiveBytes) received_ += byte;
  }

  double platform_deg() {
    const std::lock_guard hold(mutex_);
    update();
    return machine_.platform_deg();
  }
  bool turning() {
    const std::lock_guard hold(mutex_);
    update();
    return axis().speed() > 0;
  }
  std::vector<Place> log() {
    const std::lock_guard hold(mutex_);
    update();
    return log_;
  }
  std::map<int, double> settings() {
    const std::lock_guard hold(mutex_);
    return settings_.all();
  }
  void close_end_switch() {
    const std::lock_guard hold(mutex_);
    update();
    run_into_switch();
  }

 private:
  enum class State { idle, run, hold, jog, alarm, home };

  // ---------------------------------------------------------------------------------------------- time and motion

  void require_plug() const {
    if (!plugged_) throw rig::Unplugged("the documented board was unplugged; plug it in");
  }

  void update() {
    const double until_s = clock_.monotonic_s();
    while (now_s_ < until_s) {
      const bool busy = axis().turning() || state_ == State::home || dwell_s_ || !received_.empty();
      const double slice_s = busy ? std::min(kSliceS, until_s - now_s_) : until_s - now_s_;
      pass(slice_s);
    }
  }

  void pass(double slice_s) {
    const bool boots = now_s_ < boots_until_s_;
    now_s_ += slice_s;
    if (boots && now_s_ >= boots_until_s_) greet(settings_.is_on(22));
    if (now_s_ < boots_until_s_ || !plugged_) return;
    const double before_deg = machine_.platform_deg();
    axis().advance(slice_s);
    note(before_deg);
    if (state_ == State::home)
      go_on_homing();
    else if (settings_.is_on(21) && machine_.passes_switch(before_deg, machine_.platform_deg()))
      run_into_switch();
    settle();
    if (std::exchange(report_asked_, false) && state_ != State::home) report();
    while (takes_lines() && answer_next_line()) settle();
  }

  void note(double before_deg) {
    if (axis().speed() > 0 || machine_.platform_deg() != before_deg) log_.push_back({now_s_, machine_.platform_deg()});
  }

  // Makes the state follow the motor: a move, a hold or a jog has ended.
  void settle() {
    const bool stands = axis().speed() == 0;
    if (cancelling_jog_ && stands) {
      cancelling_jog_ = false;
      axis().halt();
    }
    if (beyond_limits_ && stands) {
      beyond_limits_ = false;
      axis().halt();
      alarm(2);
      reset_needed_ = true;
      say("[MSG:Reset to continue]");
    }
    if (!axis().turning() && (state_ == State::run || state_ == State::jog)) state_ = State::idle;
    if (dwell_s_ && axis().planned() == 0) end_dwell();
  }

  // It begins when the moves before it have ended.
  void end_dwell() {
    if (!dwell_begun_s_) dwell_begun_s_ = now_s_;
    if (now_s_ < *dwell_begun_s_ + *dwell_s_) return;
    dwell_s_.reset();
    dwell_begun_s_.reset();
    say("ok");
  }

  void halt() {
    machine_.halt();
    dwell_s_.reset();
    dwell_begun_s_.reset();
    cancelling_jog_ = beyond_limits_ = false;
  }

  void run_into_switch() {
    halt();
    alarm(1);
    reset_needed_ = true;
    say("[MSG:Reset to continue]");
  }

  // -------------------------------------------------------------------------------------------------- power and reset

  void boot(double for_s) {
    halt();
    machine_.count_from(0);
    said_.clear();
    received_.clear();
    state_ = State::idle;
    reset_needed_ = report_asked_ = false;
    boots_until_s_ = now_s_ + for_s;
    if (for_s <= 0) greet(settings_.is_on(22));
  }

  void greet(bool locked) {
    received_.clear();
    modes_ = {};
    offset_mm_ = 0;
    reports_to_offset_ = reports_to_overrides_ = 0;
    reset_needed_ = report_asked_ = false;
    state_ = locked ? State::alarm : State::idle;
    say("");
    say("Grbl 1.1h ['$' for help]");
    if (locked) say("[MSG:'$H'|'$X' to unlock]");
    if (settings_.is_on(21) && machine_.switch_closed()) say("[MSG:Check Limits]");
  }

  void soft_reset() {
    const bool locked = state_ == State::alarm || beyond_limits_;
    const int code = state_ == State::home ? 6 : axis().speed() > 0 ? 3 : 0;
    halt();
    if (code != 0) alarm(code);
    greet(locked || code != 0);
  }

  void alarm(int code) {
    state_ = State::alarm;
    say("ALARM:" + std::to_string(code));
  }

  // ---------------------------------------------------------------------------------------------- real-time characters

  bool real_time(char byte) {
    if (byte == '\x18') {
      soft_reset();
      return true;
    }
    const bool heard = !reset_needed_;
    if (byte == '?') {
      report_asked_ = heard;
    } else if (byte == '!') {
      if (heard) hold();
    } else if (byte == '~') {
      if (heard && state_ == State::hold && axis().speed() == 0) {
        axis().resume();
        state_ = axis().turning() ? State::run : State::idle;
      }
    } else if (byte == '\x85') {
      if (heard && state_ == State::jog) cancel_jog();
    } else {
      return static_cast<unsigned char>(byte) >= 0x80;  // overrides and others that change nothing here
    }
    return true;
  }

  void hold() {
    if (state_ == State::jog) cancel_jog();
    if (state_ != State::idle && state_ != State::run) return;
    axis().hold();
    state_ = State::hold;
  }

  void cancel_jog() {
    axis().hold();
    cancelling_jog_ = true;
  }

  void report() {
    const bool inches = settings_.is_on(13), machine = (static_cast<int>(settings_.at(10)) & 1) != 0;
    const double unit = inches ? 1 / kMmPerInch : 1;
    const auto place = [&](double x_mm) { return documented_text("%.3f,0.000,0.000", x_mm * unit); };
    std::string line =
        "<" + state_name() + (machine ? "|MPos:" : "|WPos:") + place(machine_mm() - (machine ? 0 : offset_mm_));
    if ((static_cast<int>(settings_.at(10)) & 2) != 0)
      line += documented_text("|Bf:%zu,%zu", kPlannerBlocks - axis().planned(), kReceiveBytes - received_.size());
    line += documented_text("|FS:%.0f,0", axis().speed() / settings_.at(100) * 60 * unit);
    if (machine_.switch_closed()) line += "|Pn:X";
    const bool moves = state_ == State::run || state_ == State::jog || state_ == State::hold;
    if (--reports_to_offset_ < 0) {
      reports_to_offset_ = moves ? 29 : 9;
      line += "|WCO:" + place(offset_mm_);
    } else if (--reports_to_overrides_ < 0) {
      reports_to_overrides_ = moves ? 19 : 9;
      line += "|Ov:100,100,100";
    }
    say(line + ">");
  }

  std::string state_name() const {
    switch (state_) {
      case State::idle:
        return "Idle";
      case State::run:
        return "Run";
      case State::hold:
        return axis().speed() > 0 ? "Hold:1" : "Hold:0";
      case State::jog:
        return "Jog";
      case State::alarm:
        return "Alarm";
      case State::home:
        return "Home";
    }
    return "Idle";
  }

  // ------------------------------------------------------------------------------------------------------------ lines

  void say(const std::string& line) { said_ += line + "\r\n"; }

  bool takes_lines() const {
    return state_ != State::home && state_ != State::hold && !cancelling_jog_ && !beyond_limits_ && !dwell_s_ &&
           !reset_needed_ && axis().planned() < kPlannerBlocks;
  }

  bool answer_next_line() {
    const std::size_t end = received_.find_first_of("\r\n");
    if (end == std::string::npos) return false;
    const std::string line = tidied(received_.substr(0, end));
    received_.erase(0, end + 1);
    const std::optional<int> error = line.size() > kLineCharacters ? 11
                                     : line.empty()                ? 0
                                     : line.front() == '$'         ? system_line(line)
                                                                   : code_line(line, false);
    if (error) say(*error == 0 ? "ok" : "error:" + std::to_string(*error));
    return true;
  }

  // The error of a line that begins with "$", 0 for none; nothing when the answer comes later.
  std::optional<int> system_line(const std::string& line) {
    if (line == "$") return print({"[HLP:$$ $# $G $I $N $x=val $Nx=line $J=line $SLP $C $X $H ~ ! ? ctrl-x]"});
    if (line == "$G") return print({parser_state()});
    if (line.starts_with("$J=")) {
      if (state_ != State::idle && state_ != State::jog) return 8;
      return code_line(line.substr(3), true);
    }
    if (state_ != State::idle && state_ != State::alarm) return 8;
    if (line == "$X") {
      if (std::exchange(state_, State::idle) == State::alarm) say("[MSG:Caution: Unlocked]");
      return 0;
    }
    if (line == "$$") return print(settings_.lines());
    if (line == "$I")
      return print({"[VER:1.1h.20190830:]", options_.homes_single_axis ? "[OPT:VH,15,128]" : "[OPT:V,15,128]"});
    if (line == "$N") return print({"$N0=", "$N1="});
    if (line == "$#") return print(parameter_lines());
    if (line == "$H" || line == "$HX" || line == "$HY" || line == "$HZ") return begin_homing(line);
    if (line == "$RST=$") {
      settings_.restore();
      say("[MSG:Restoring defaults]");
      return 0;
    }
    return settings_.set(line);
  }

  int print(const std::vector<std::string>& lines) {
    for (const std::string& line : lines) say(line);
    return 0;
  }

  std::string parser_state() const {
    return documented_text("[GC:G%d G%d G17 G%d G%d G94 M5 M9 T0 F%.0f S0]", modes_.motion, modes_.system,
                           modes_.inches ? 20 : 21, modes_.incremental ? 91 : 90, modes_.feed);
  }

  std::vector<std::string> parameter_lines() const {
    std::vector<std::string> lines;
    for (const char* name : {"G54", "G55", "G56", "G57", "G58", "G59", "G28", "G30"})
      lines.push_back("[" + std::string(name) + ":0.000,0.000,0.000]");
    lines.push_back(documented_text("[G92:%.3f,0.000,0.000]", offset_mm_));
    lines.insert(lines.end(), {"[TLO:0.000]", "[PRB:0.000,0.000,0.000:0]"});
    return lines;
  }

  // ------------------------------------------------------------------------------------------------------------- moves

  DocumentedAxis& axis() { return machine_.axis(); }
  const DocumentedAxis& axis() const { return machine_.axis(); }
  double machine_mm() const { return std::round(axis().steps()) / settings_.at(100); }
  double planned_mm() const { return std::round(axis().end()) / settings_.at(100); }

  std::optional<int> code_line(const std::string& line, bool jog) {
    if (state_ == State::alarm || (state_ == State::jog && !jog)) return 9;
    const auto read = read_documented_code(line, jog, modes_);
    if (const int* error = std::get_if<int>(&read)) return *error;
    const auto& code = std::get<DocumentedCode>(read);
    switch (code.kind) {
      case DocumentedCode::Kind::nothing:
        return 0;
      case DocumentedCode::Kind::dwell:
        dwell_s_ = code.dwell_s;
        return std::nullopt;
      case DocumentedCode::Kind::offset:
        if (code.axes[0]) offset_mm_ = planned_mm() - *code.axes[0];
        reports_to_offset_ = 0;
        return 0;
      case DocumentedCode::Kind::no_offset:
        offset_mm_ = 0;
        reports_to_offset_ = 0;
        return 0;
      case DocumentedCode::Kind::move:
        return code.axes[0] ? plan(code, jog) : 0;
    }
    return 0;
  }

  std::optional<int> plan(const DocumentedCode& code, bool jog) {
    const double from_mm = code.machine ? 0 : code.incremental ? planned_mm() : offset_mm_;
    const double target_mm = from_mm + *code.axes[0];
    if (settings_.is_on(20) && (target_mm > 0 || target_mm < -settings_.at(130))) {
      if (jog) return 15;
      axis().hold();
      beyond_limits_ = true;
      return std::nullopt;
    }
    const double largest = settings_.at(110), speed = code.rapid ? largest : std::min(code.feed, largest);
    add_move(std::round(target_mm * settings_.at(100)), speed);
    if (axis().turning()) state_ = jog ? State::jog : State::run;
    return 0;
  }

  void add_move(double target_steps, double mm_per_minute) {
    if (std::round(axis().end()) == target_steps) return;
    axis().add({.target = target_steps,
                .speed = mm_per_minute / 60 * settings_.at(100),
                .acceleration = settings_.at(120) * settings_.at(100)});
  }

  // ------------------------------------------------------------------------------------------------------------ homing

  std::optional<int> begin_homing(const std::string& line) {
    if (line != "$H" && !options_.homes_single_axis) return 3;
    if (!settings_.is_on(22)) return 5;
    const bool z_first = options_.homing == DocumentedGrblOptions::Homing::z_first;
    homing_.begin(line == "$HY" || line == "$HZ" || (line == "$H" && z_first), line == "$H" || line == "$HX", now_s_);
    state_ = State::home;
    return std::nullopt;
  }

  void go_on_homing() {
    const std::optional<int> code = homing_.go_on(now_s_);
    if (!code) return;
    state_ = State::idle;
    if (*code == 0)
      say("ok");
    else
      alarm(*code);
  }

  std::mutex mutex_;
  rig::Clock& clock_;
  DocumentedGrblOptions options_;
  DocumentedSettings settings_;
  DocumentedMachine machine_;
  DocumentedHoming homing_{machine_, settings_, options_};
  double now_s_, boots_until_s_ = 0;
  bool plugged_ = true, open_ = false;
  std::string said_, received_;
  State state_ = State::idle;
  DocumentedModes modes_;
  double offset_mm_ = 0;  // G92
  bool reset_needed_ = false, report_asked_ = false, cancelling_jog_ = false, beyond_limits_ = false;
  std::optional<double> dwell_s_, dwell_begun_s_;
  int reports_to_offset_ = 0, reports_to_overrides_ = 0;
  std::vector<Place> log_;
};

class DocumentedGrbl::Line final : public rig::ByteLine {
 public:
  Line(std::shared_ptr<Board> board, rig::Clock& clock) : board_(std::move(board)), clock_(clock) { board_->open(); }
  ~Line() override { board_->close(); }
  Line(const Line&) = delete;
  Line& operator=(const Line&) = delete;

  std::string read(double timeout_s) override {
    const double until_s = clock_.monotonic_s() + timeout_s;
    for (;;) {
      std::string bytes = board_->take();
      const double left_s = until_s - clock_.monotonic_s();
      if (!bytes.empty() || left_s <= 0) return bytes;
      clock_.sleep_s(std::min(kSliceS, left_s));
    }
  }
  void write(std::string_view bytes) override { board_->receive(bytes); }

 private:
  std::shared_ptr<Board> board_;
  rig::Clock& clock_;
};

DocumentedGrbl::DocumentedGrbl(rig::Clock& clock, const DocumentedGrblOptions& options)
    : clock_(clock), board_(std::make_shared<Board>(clock, options)) {}

std::unique_ptr<rig::ByteLine> DocumentedGrbl::open() {
  return std::make_unique<Line>(board_, clock_);
}
void DocumentedGrbl::unplug() {
  board_->plug(false);
}
void DocumentedGrbl::plug_in() {
  board_->plug(true);
}
double DocumentedGrbl::platform_deg() {
  return board_->platform_deg();
}
bool DocumentedGrbl::turning() {
  return board_->turning();
}
std::vector<DocumentedGrbl::Place> DocumentedGrbl::log() {
  return board_->log();
}
std::map<int, double> DocumentedGrbl::settings() {
  return board_->settings();
}
void DocumentedGrbl::close_end_switch() {
  board_->close_end_switch();
}
