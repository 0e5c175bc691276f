// The makes of camera that can be simulated.
#pragma once

namespace rig {

enum class CameraMake { sony, canon, nikon };

// What a camera of each make writes into its raw files, and the extension of their names.
struct RawNames {
  const char *make, *model, *extension;
};

constexpr RawNames raw_names(CameraMake make) {
  switch (make) {
    case CameraMake::canon:
      return {"Canon", "Canon EOS 6D", "cr2"};
    case CameraMake::nikon:
      return {"NIKON CORPORATION", "NIKON D750", "nef"};
    case CameraMake::sony:
      break;
  }
  return {"SONY", "ILCE-7M2", "arw"};
}

}  // namespace rig
