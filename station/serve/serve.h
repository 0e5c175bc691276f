// The technician's page over HTTP: the work behind `threadstation serve`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace station {

struct ServeRequest {
  std::filesystem::path rig, workspace;
  std::uint16_t port = 8017;  // 0: a free one
  bool lan = false;           // on all addresses of this computer; else on its loopback alone
  std::string token;          // needed for lan, possible otherwise
  std::vector<std::string> hosts;
};

// Prints the address, and answers until ctrl-C; a run that the page started goes on. Errors: std::runtime_error with
// one line: lan without a token or a name, a short token, a port that is taken, those of TechnicianPage.
void serve(const ServeRequest& request);

}  // namespace station
