// Debian's own gphoto2 command, connected to a simulated camera.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "tests/rig/cameras/wired_camera.h"

class Gphoto2 {
 public:
  explicit Gphoto2(const WiredCamera& wired)
      : port_(wired.port()),
        folder_(std::filesystem::path(testing::TempDir()) / ("gphoto2_" + std::to_string(wired.server->port()))) {
    EXPECT_EQ(std::system("command -v gphoto2 >/dev/null"), 0) << "install gphoto2, as station/packages.txt says";
    std::filesystem::create_directories(folder_);
  }
  ~Gphoto2() { std::filesystem::remove_all(folder_); }
  Gphoto2(const Gphoto2&) = delete;
  Gphoto2& operator=(const Gphoto2&) = delete;

  // What it prints; it remembers cameras in its home, so it gets one of its own.
  std::string run(const std::string& arguments) const {
    const std::string command = "cd " + folder_.string() + " && HOME=" + folder_.string() + " gphoto2 --port " + port_ +
                                " " + arguments + " 2>&1";
    std::string said;
    FILE* pipe = popen(command.c_str(), "r");
    std::array<char, 4096> piece{};
    for (std::size_t got = 0; (got = fread(piece.data(), 1, piece.size(), pipe)) > 0;) said.append(piece.data(), got);
    EXPECT_EQ(pclose(pipe), 0) << command << "\n" << said;
    return said;
  }
  // Of a file that it wrote.
  std::vector<std::byte> bytes_of(const std::string& name) const {
    std::ifstream in(folder_ / name, std::ios::binary);
    EXPECT_TRUE(in) << name;
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    const auto* begin = reinterpret_cast<const std::byte*>(text.data());
    return {begin, begin + text.size()};
  }
  std::size_t files_ending_in(const std::string& extension) const {
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder_))
      count += entry.path().extension() == extension;
    return count;
  }

 private:
  std::string port_;
  std::filesystem::path folder_;
};
