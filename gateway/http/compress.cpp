// SPDX-License-Identifier: Apache-2.0
#include <zlib.h>

#include <array>
#include <stdexcept>

#include "gateway/http/message.hpp"

namespace asip::gateway::http {
namespace {

constexpr int kGzip = 16 + MAX_WBITS;

template <class Step>
std::string run(z_stream& stream, std::string_view input, Step step) {
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(input.data()));
    stream.avail_in = static_cast<uInt>(input.size());
    std::string output;
    std::array<char, 16384> piece;
    for (int result = Z_OK; result == Z_OK;) {
        stream.next_out = reinterpret_cast<Bytef*>(piece.data());
        stream.avail_out = piece.size();
        result = step();
        output.append(piece.data(), piece.size() - stream.avail_out);
    }
    return output;
}

}  // namespace

std::string compress(std::string_view text) {
    z_stream stream{};
    if (deflateInit2(&stream, 1, Z_DEFLATED, kGzip, 8, Z_DEFAULT_STRATEGY) != Z_OK)
        throw std::runtime_error("zlib");
    auto output = run(stream, text, [&] { return deflate(&stream, Z_FINISH); });
    deflateEnd(&stream);
    return output;
}

std::string decompress(std::string_view gzip) {
    z_stream stream{};
    if (inflateInit2(&stream, kGzip) != Z_OK) throw std::runtime_error("zlib");
    auto output = run(stream, gzip, [&] { return inflate(&stream, Z_NO_FLUSH); });
    inflateEnd(&stream);
    return output;
}

}  // namespace asip::gateway::http
