// Connections to the simulated camera that say nothing, or only the beginning of something.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <deque>
#include <optional>

#include "rig/cameras/ptp_bytes.h"
#include "tests/rig/cameras/wired_camera.h"

namespace {

constexpr std::uint32_t kInitCommandAck = 2, kInitFail = 5, kResponse = 7;

class Caller {
 public:
  explicit Caller(const WiredCamera& wired) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    const timeval patience{.tv_sec = 2, .tv_usec = 500000};  // libgphoto2's
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(wired.server->port()));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  }
  ~Caller() { ::close(socket_); }
  Caller(const Caller&) = delete;
  Caller& operator=(const Caller&) = delete;

  void say(const std::string& bytes) const {
    EXPECT_EQ(::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL), static_cast<ssize_t>(bytes.size()));
  }
  // The type of the packet that is the answer; nothing when none comes.
  std::optional<std::uint32_t> answer() const {
    std::array<char, 256> bytes{};
    const ssize_t got = ::recv(socket_, bytes.data(), bytes.size(), 0);
    return got < 0 ? std::nullopt : rig::ptp_number<std::uint32_t>({bytes.data(), static_cast<std::size_t>(got)}, 4);
  }
  bool ended() const {
    char byte = 0;
    return ::recv(socket_, &byte, 1, 0) == 0;
  }

 private:
  int socket_;
};

std::string packet(std::uint32_t type, const std::string& body) {
  return rig::PtpWriter().put(static_cast<std::uint32_t>(8 + body.size())).put(type).bytes(body).take();
}

std::string greeting() {
  rig::PtpWriter body;
  body.bytes(std::string(16, 'g')).wide_text("test").put(std::uint32_t{0x10000});
  return packet(1, body.take());
}

std::string open_session() {
  rig::PtpWriter body;
  body.put(std::uint32_t{1}).put(std::uint16_t{0x1002}).put(std::uint32_t{0}).put(std::uint32_t{1});
  return packet(6, body.take());
}

}  // namespace

TEST(PtpipServer, AConnectionThatSaysNothingKeepsNobodyWaiting) {
  const WiredCamera wired;
  const Caller silent(wired), halting(wired), host(wired);
  halting.say(greeting().substr(0, 11));
  host.say(greeting());
  EXPECT_EQ(host.answer(), kInitCommandAck);
}

TEST(PtpipServer, TheLongestSilentOfManyConnectionsAreLetGo) {
  const WiredCamera wired;
  std::deque<Caller> silent;
  for (int i = 0; i < 100; ++i) silent.emplace_back(wired);
  const Caller host(wired);
  host.say(greeting());
  EXPECT_EQ(host.answer(), kInitCommandAck);
  EXPECT_TRUE(silent.front().ended());
}

TEST(PtpipServer, AConnectionThatLeavesWithoutAWordCostsTheHostNothing) {
  const WiredCamera wired;
  const Caller host(wired);
  host.say(greeting());
  ASSERT_EQ(host.answer(), kInitCommandAck);
  {
    const Caller silent(wired), halting(wired), noisy(wired);
    halting.say(greeting().substr(0, 11));
    noisy.say(std::string(40, '\xff'));
  }
  const Caller second(wired);
  second.say(greeting());
  EXPECT_EQ(second.answer(), kInitFail) << "the camera is held by the first";
  host.say(open_session());
  EXPECT_EQ(host.answer(), kResponse);
}
