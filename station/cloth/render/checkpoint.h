// The film of a rendering that was interrupted, on disk beside its picture: a line of JSON that says which rendering it
// belongs to, then the film's numbers as this machine holds them, then the SHA-256 of all before it.
#pragma once

#include <filesystem>
#include <optional>

#include "renderer/picture/film.h"
#include "station/cloth/render/render_identity.h"

namespace station {

// a.exr -> a.exr.checkpoint
std::filesystem::path checkpoint_of(const std::filesystem::path& picture);

// Stores the checkpoint whole or not at all. Errors: those of store_file (documents/disk/stored_file.h).
void store_checkpoint(const std::filesystem::path& file, const RenderIdentity& identity, const renderer::Film& film);

// The film of the checkpoint; nothing when there is no such file. Errors: std::runtime_error with one line when it is
// damaged, or belongs to another scene, seed, number of samples, version or size of picture.
std::optional<renderer::Film> read_checkpoint(const std::filesystem::path& file, const RenderIdentity& identity,
                                              const cv::Size& picture);

}  // namespace station
