// The film of a rendering that was interrupted, on disk beside its picture: a line of JSON that says which rendering it
// belongs to, then the film's numbers as this machine holds them, then the SHA-256 of all before it. Parts have the
// goals of all tiles and the records (renderer/picture/tile_share.h) of theirs.
#pragma once

#include <filesystem>
#include <optional>

#include "renderer/picture/tile_share.h"
#include "station/cloth/render/render_identity.h"

namespace station {

// a.exr -> a.exr.checkpoint
std::filesystem::path checkpoint_of(const std::filesystem::path& picture);
// Several processes that draw one picture store a part each (cloth/render/ranks.h): a.exr -> a.exr.checkpoint.2of8
std::filesystem::path part_of(const std::filesystem::path& picture, const renderer::TileShare& share);

// Stores the checkpoint whole or not at all. Errors: those of store_file (documents/disk/stored_file.h).
void store_checkpoint(const std::filesystem::path& file, const RenderIdentity& identity, const renderer::Film& film);
// The same for the tiles of one share.
void store_part(const std::filesystem::path& file, const RenderIdentity& identity, const renderer::Film& film,
                const renderer::TileShare& share);

// What the checkpoint of the picture and its parts, of however many processes, have of its film; nothing when there is
// none of them. Errors: std::runtime_error with one line when one is damaged, or belongs to another scene, seed, number
// of samples, version or size of picture.
std::optional<renderer::Film> read_checkpoint(const std::filesystem::path& picture, const RenderIdentity& identity,
                                              const cv::Size& size);

bool has_parts(const std::filesystem::path& picture);
void remove_parts(const std::filesystem::path& picture);

}  // namespace station
