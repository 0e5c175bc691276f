#include "rig/simulated/ptpip_server.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "rig/cameras/ptp_bytes.h"

namespace rig {
namespace {

constexpr std::uint32_t kInitCommand = 1, kInitCommandAck = 2, kInitEvent = 3, kInitEventAck = 4, kInitFail = 5,
                        kRequest = 6, kResponse = 7, kEvent = 8, kStartData = 9, kData = 10, kEndData = 12, kPing = 13,
                        kPong = 14;
constexpr std::size_t kHeader = 8, kLargestPacket = 1 << 20, kPiece = 1 << 16;
constexpr int kPicturesEveryMs = 5;     // how often the server looks for pictures that became ready
constexpr std::size_t kMostGuests = 8;  // connections that have not said yet which they are
// The header of a packet of an unknown type whose announced length, more than a kilobyte, never comes.
constexpr std::string_view kNoise("\x00\x05\x00\x00\xff\xfe\x81\x07\xc3", 9);

class Socket {
 public:
  Socket() = default;
  explicit Socket(int descriptor) : descriptor_(descriptor) {}
  Socket(Socket&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  Socket& operator=(Socket&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    return *this;
  }
  ~Socket() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  int get() const { return descriptor_; }
  bool open() const { return descriptor_ >= 0; }

 private:
  int descriptor_ = -1;
};

struct Broken {};  // thrown when the host is gone or speaks another protocol

void send_all(const Socket& socket, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(socket.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent <= 0) throw Broken{};
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
}

std::string receive_exactly(const Socket& socket, std::size_t count) {
  std::string bytes(count, '\0');
  for (std::size_t got = 0; got < count;) {
    const ssize_t more = ::recv(socket.get(), bytes.data() + got, count - got, 0);
    if (more <= 0) throw Broken{};
    got += static_cast<std::size_t>(more);
  }
  return bytes;
}

struct Packet {
  std::uint32_t type = 0;
  std::string body;
};

// The length of the packet that begins with this header.
std::size_t packet_length(std::string_view header) {
  const std::uint32_t length = *ptp_number<std::uint32_t>(header, 0);
  if (length < kHeader || length > kLargestPacket) throw Broken{};
  return length;
}

Packet receive_packet(const Socket& socket) {
  const std::string header = receive_exactly(socket, kHeader);
  return {*ptp_number<std::uint32_t>(header, 4), receive_exactly(socket, packet_length(header) - kHeader)};
}

// A connection that has not said yet which of the two it is. Nobody waits for it, because it may stay silent for ever.
struct Guest {
  Socket socket;
  std::string said;
};

// The guest's first packet, once it is whole; bytes that come after it are left where they are.
std::optional<Packet> first_packet(Guest& guest) {
  for (;;) {
    const bool measured = guest.said.size() >= kHeader;
    const std::size_t length = measured ? packet_length(guest.said) : kHeader;
    if (measured && guest.said.size() == length)
      return Packet{*ptp_number<std::uint32_t>(guest.said, 4), guest.said.substr(kHeader)};
    std::string piece(length - guest.said.size(), '\0');
    const ssize_t more = ::recv(guest.socket.get(), piece.data(), piece.size(), MSG_DONTWAIT);
    if (more < 0 && (errno == EAGAIN || errno == EINTR)) return std::nullopt;
    if (more <= 0) throw Broken{};
    guest.said.append(piece, 0, static_cast<std::size_t>(more));
  }
}

std::string packet(std::uint32_t type, const std::string& body) {
  return PtpWriter().put(static_cast<std::uint32_t>(kHeader + body.size())).put(type).bytes(body).take();
}

class TcpServer final : public PtpipServer {
 public:
  TcpServer(SimulatedBody& camera, int port, CameraFaultPlan plan)
      : camera_(camera), plan_(std::move(plan)), port_(port) {
    listen_there();
    thread_ = std::jthread([this](const std::stop_token& ending) { serve(ending); });
  }

  int port() const override { return port_; }
  void unplug() override {
    plugged_ = false;
    while (listening_) std::this_thread::yield();
  }
  void plug_in() override {
    plugged_ = true;
    while (!listening_) std::this_thread::yield();
  }
  void cut_after(long bytes) override { cut_after_ = bytes; }
  int operations() override { return operations_; }

 private:
  void listen_there() {
    Socket socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    const int yes = 1;
    setsockopt(socket.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port_));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    if (!socket.open() || ::bind(socket.get(), reinterpret_cast<sockaddr*>(&address), size) != 0 ||
        ::listen(socket.get(), SOMAXCONN) != 0 ||
        ::getsockname(socket.get(), reinterpret_cast<sockaddr*>(&address), &size) != 0) {
      throw std::runtime_error("the simulated camera was to listen at port " + std::to_string(port_) +
                               " of this computer and cannot (" + std::strerror(errno) + "); choose another port");
    }
    port_ = ntohs(address.sin_port);
    door_ = std::move(socket);
    listening_ = true;
  }

  void serve(const std::stop_token& ending) {
    while (!ending.stop_requested()) {
      try {
        serve_once();
      } catch (const Broken&) {
        hang_up();
      }
    }
  }

  void hang_up() {
    command_ = Socket();
    event_ = Socket();
    announced_ = 0;
  }

  void serve_once() {
    if (!plugged_) {
      hang_up();
      guests_.clear();
      door_ = Socket();
      listening_ = false;
      std::this_thread::sleep_for(std::chrono::milliseconds(kPicturesEveryMs));
      return;
    }
    if (!door_.open()) listen_there();
    std::vector<pollfd> watched{pollfd{door_.get(), POLLIN, 0}, pollfd{command_.get(), POLLIN, 0},
                                pollfd{event_.get(), POLLIN, 0}};  // poll() skips negative descriptors
    for (const Guest& guest : guests_) watched.push_back({guest.socket.get(), POLLIN, 0});
    ::poll(watched.data(), watched.size(), kPicturesEveryMs);
    if (watched[1].revents != 0) answer(receive_packet(command_));
    if (watched[2].revents != 0 && receive_packet(event_).type == kPing) send_all(event_, packet(kPong, ""));
    std::erase_if(guests_, [this](Guest& guest) { return leaves(guest); });
    if (watched[0].revents != 0) let_in(Socket(::accept4(door_.get(), nullptr, nullptr, SOCK_CLOEXEC)));
    announce();
  }

  void let_in(Socket caller) {
    const int yes = 1;
    setsockopt(caller.get(), IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    const timeval patience{.tv_sec = 5, .tv_usec = 0};
    setsockopt(caller.get(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    setsockopt(caller.get(), SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
    if (guests_.size() == kMostGuests) guests_.erase(guests_.begin());  // the one that has been silent for longest
    guests_.push_back({.socket = std::move(caller), .said = {}});
  }

  // True when the guest has been given its place, or is gone. Whatever it says costs the host nothing.
  bool leaves(Guest& guest) {
    try {
      const auto first = first_packet(guest);
      if (first) welcome(*first, std::move(guest.socket));
      return first.has_value();
    } catch (const Broken&) {
      return true;
    }
  }

  // The first packet says which of the two connections it is.
  void welcome(const Packet& first, Socket guest) {
    if (first.type == kInitCommand && command_.open()) {
      constexpr std::uint32_t kBusy = 2;
      send_all(guest, packet(kInitFail, PtpWriter().put(kBusy).take()));
    } else if (first.type == kInitCommand) {
      PtpWriter ack;
      ack.put(std::uint32_t{1}).bytes("threadstation-7M").wide_text(camera_.name()).put(std::uint32_t{0x10000});
      send_all(guest, packet(kInitCommandAck, ack.take()));
      command_ = std::move(guest);
    } else if (first.type == kInitEvent) {
      send_all(guest, packet(kInitEventAck, ""));
      event_ = std::move(guest);
    }
  }

  void answer(const Packet& asked) {
    const auto phase = ptp_number<std::uint32_t>(asked.body, 0);
    const auto code = ptp_number<std::uint16_t>(asked.body, 4);
    const auto transaction = ptp_number<std::uint32_t>(asked.body, 6);
    if (asked.type != kRequest || !phase || !code || !transaction) throw Broken{};
    PtpRequest request{.code = *code, .parameters = {}, .data = {}};
    for (std::size_t at = 10; const auto parameter = ptp_number<std::uint32_t>(asked.body, at); at += 4)
      request.parameters.push_back(*parameter);
    if (*phase == 2) request.data = receive_data();
    const auto fault = next_fault();
    if (fault == CameraFault::silence) return;
    if (fault == CameraFault::unplug) {
      plugged_ = false;
      throw Broken{};
    }
    const PtpAnswer answer = camera_.handle(request);
    if (fault == CameraFault::lost_answer) return;
    if (fault == CameraFault::garbage) {
      send_all(command_, std::string(kNoise));
      return;
    }
    if (fault == CameraFault::cut) cut_short(answer, *transaction);
    if (answer.data) send_data(*answer.data, *transaction, answer.is_picture);
    PtpWriter response;
    response.put(answer.code).put(*transaction);
    send_all(command_, packet(kResponse, response.take()));
  }

  // Counts an operation and returns its fault, if it has one. A fault that lasts is set as the camera's condition.
  std::optional<CameraFault> next_fault() {
    ++operations_;
    const auto found = std::ranges::find(plan_, operations_.load(), &PlannedCameraFault::at_operation);
    if (found == plan_.end()) return std::nullopt;
    switch (found->fault) {
      case CameraFault::refused_shutter:
        camera_.set_condition({.shutter_locked = true});
        break;
      case CameraFault::refused_iso:
        camera_.set_condition({.iso_locked = true});
        break;
      case CameraFault::refused_f_number:
        camera_.set_condition({.f_number_locked = true});
        break;
      case CameraFault::refused_quality:
        camera_.set_condition({.quality_locked = true});
        break;
      case CameraFault::overstepped:
        camera_.set_condition({.oversteps = true});
        break;
      case CameraFault::stale_picture:
        camera_.set_condition({.repeats_last_picture = true});
        break;
      case CameraFault::store_full:
        camera_.set_condition({.store_full = true});
        break;
      case CameraFault::battery_empty:
        camera_.set_condition({.battery_percent = 1});
        break;
      case CameraFault::dial_turned:
        camera_.set_condition({.exposure_program = 2});
        break;
      default:
        break;
    }
    return found->fault;
  }

  [[noreturn]] void cut_short(const PtpAnswer& answer, std::uint32_t transaction) {
    PtpWriter part;
    part.put(transaction).bytes(answer.data.value_or(""));
    const std::string whole = packet(answer.data ? kEndData : kResponse, part.take());
    if (answer.data) {
      PtpWriter start;
      start.put(transaction).put(static_cast<std::uint64_t>(answer.data->size()));
      send_all(command_, packet(kStartData, start.take()));
    }
    send_all(command_, std::string_view(whole).substr(0, whole.size() / 2));
    throw Broken{};
  }

  std::string receive_data() {
    std::string data;
    for (;;) {
      const Packet part = receive_packet(command_);
      if (part.type == kStartData) continue;
      if ((part.type != kData && part.type != kEndData) || part.body.size() < 4 || data.size() > kLargestPacket)
        throw Broken{};
      data += part.body.substr(4);
      if (part.type == kEndData) return data;
    }
  }

  void send_data(const std::string& data, std::uint32_t transaction, bool picture) {
    PtpWriter start;
    start.put(transaction).put(static_cast<std::uint64_t>(data.size()));
    send_all(command_, packet(kStartData, start.take()));
    const long cut = picture ? cut_after_.exchange(-1) : -1;
    for (std::size_t begin = 0; begin == 0 || begin < data.size(); begin += kPiece) {
      const bool last = begin + kPiece >= data.size();
      PtpWriter part;
      part.put(transaction).bytes(std::string_view(data).substr(begin, kPiece));
      const std::string whole = packet(last ? kEndData : kData, part.take());
      if (cut >= 0 && begin + kPiece > static_cast<std::size_t>(cut)) {
        send_all(command_, std::string_view(whole).substr(0, kHeader + 4 + static_cast<std::size_t>(cut) - begin));
        throw Broken{};
      }
      send_all(command_, whole);
    }
  }

  // Sends one event for each picture that became ready, if the camera is one that does.
  void announce() {
    const auto told = camera_.picture_event();
    if (!told) return;
    const int waiting = camera_.waiting_pictures();
    announced_ = std::min(announced_, waiting);
    for (; event_.open() && announced_ < waiting; ++announced_) {
      PtpWriter event;
      event.put(told->first).put(std::uint32_t{0}).put(told->second);
      send_all(event_, packet(kEvent, event.take()));
    }
  }

  SimulatedBody& camera_;
  const CameraFaultPlan plan_;
  std::atomic<int> port_;
  Socket door_, command_, event_;
  std::vector<Guest> guests_;  // the longest waiting first
  int announced_ = 0;
  std::atomic<int> operations_ = 0;
  std::atomic<bool> plugged_ = true, listening_ = false;
  std::atomic<long> cut_after_ = -1;
  std::jthread thread_;  // the last member, so that the thread ends before what it uses is destroyed
};

}  // namespace

std::unique_ptr<PtpipServer> serve_on_ptpip(SimulatedBody& camera, int port, CameraFaultPlan plan) {
  return std::make_unique<TcpServer>(camera, port, std::move(plan));
}

}  // namespace rig
