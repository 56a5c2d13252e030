/* The META section of an asset: which program made it, with which options, from which source;
 * not when or where. */
#pragma once

#include "cook/options.hpp"
#include "cook/report.hpp"

namespace gtx {

std::string write_meta(const Options &options, const CookFacts &facts);

/* The key of an asset, and the warnings that it was cooked with; false when META does not tell. */
bool read_meta(const gtx_asset *asset, uint64_t &key, std::bitset<GTX_WARNING_COUNT> &warnings);
/* The hash of the models' content that it was cooked from; false when META does not tell. */
bool read_source_hash(const gtx_asset *asset, uint64_t &hash);
/* Whether META tells that it was cooked as a part of a closed surface. */
bool was_closed(const gtx_asset *asset);

} // namespace gtx
