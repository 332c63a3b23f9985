// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>

#include "gateway/api/routes.hpp"
#include "gateway/page_files.hpp"

namespace asip::gateway::api {
namespace {

constexpr std::array<std::pair<std::string_view, std::string_view>, 8> kTypes{{
    {".html", "text/html; charset=utf-8"},
    {".css", "text/css; charset=utf-8"},
    {".js", "text/javascript; charset=utf-8"},
    {".svg", "image/svg+xml"},
    {".png", "image/png"},
    {".json", "application/json"},
    {".webmanifest", "application/manifest+json"},
    {".txt", "text/plain; charset=utf-8"},
}};

std::string_view type_of(std::string_view path) {
    for (const auto& [ending, type] : kTypes)
        if (path.ends_with(ending)) return type;
    return "application/octet-stream";
}

// The page may be shown inside pages of the origins that a kiosk's token names, nowhere else.
std::string policy(const std::vector<std::string>& frames) {
    std::string ancestors = "'none'";
    if (!frames.empty()) {
        ancestors.clear();
        for (const auto& origin : frames)
            ancestors += (ancestors.empty() ? "" : " ") + origin;
    }
    return "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src 'self' "
           "data:; "
           "manifest-src 'self'; worker-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors " +
           ancestors + "; require-trusted-types-for 'script'; trusted-types page";
}

const PageFile* file_of(const std::string& path) {
    const auto files = page_files();
    const auto found =
        std::find_if(files.begin(), files.end(), [&](const PageFile& file) { return file.path == path; });
    return found == files.end() ? nullptr : &*found;
}

}  // namespace

void serve_page(Gateway& gateway, const http::Request& request, const http::Reply& reply,
                const http::Peer& peer, const Rights* kiosk) {
    std::string path;
    for (const auto& segment : request.segments)
        path += (path.empty() ? "" : "/") + segment;
    if (path.empty()) {
        const auto* code = request.parameter("code");
        if (code != nullptr && request.method == "GET" && kiosk == nullptr)
            return log_in(gateway, request, peer, *code, reply);
        path = "index.html";
    }
    if (path == "join" && kiosk == nullptr) {  // an address that people can type
        http::Response response;
        response.status = 303;
        response.content_type = "text/plain";
        response.headers = {{"Location", gateway.options().base_path + "/#/join"},
                            {"Cache-Control", "no-store"}};
        return reply.send(std::move(response));
    }
    const auto* file = gateway.options().page ? file_of(path) : nullptr;
    if (file == nullptr) return reply.send(problem(404, "there is nothing at this address"));
    if (request.method != "GET" && request.method != "HEAD") {
        http::Response response;
        response.status = 204;
        if (request.method != "OPTIONS") response = problem(405, "only GET, HEAD, OPTIONS");
        response.headers.emplace_back("Allow", "GET, HEAD, OPTIONS");
        return reply.send(std::move(response));
    }
    http::Response response;
    response.content_type = type_of(path);
    response.by_encoding = true;
    const auto etag = "\"" + std::string(file->etag) + "\"";
    response.headers = {
        {"ETag", "W/" + etag},
        {"Cache-Control", "no-cache"},
        {"Content-Security-Policy", policy(kiosk == nullptr ? std::vector<std::string>() : kiosk->frames)}};
    if (request.header("if-none-match").find(etag) != std::string_view::npos) {
        response.status = 304;
    } else if (http::accepts_gzip(request)) {
        response.fixed = file->gzip;
        response.compressed = true;
    } else {
        response.body = http::decompress(file->gzip);
    }
    reply.send(std::move(response));
}

}  // namespace asip::gateway::api
