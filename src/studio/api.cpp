#include "studio/api.h"

#include <exception>
#include <fmt/format.h>
#include <memory>
#include <span>

#include "studio/guard.h"
#include "studio/studio_json.h"
#include "view/built_files.h"

namespace aerate::studio {
namespace {

constexpr const char* kBinary = "application/octet-stream";

Answer of(const Json& json) {
  return {.body = text_of(json)};
}

Answer of(KeptFile file, const char* type) {
  return {.type = type, .file = std::move(file)};
}

// "/api/jobs/j1/stop" -> "jobs", "j1", "stop"
std::vector<std::string> words_of(std::string_view path) {
  std::vector<std::string> words;
  while (!path.empty()) {
    path.remove_prefix(1);
    const std::size_t slash = path.find('/');
    words.emplace_back(path.substr(0, slash));
    path = slash == std::string_view::npos ? std::string_view() : path.substr(slash);
  }
  if (!words.empty()) words.erase(words.begin());
  return words;
}

std::string whole(const BodyReader& body) {
  std::string text;
  const auto take = [&](std::string_view piece) {
    if (piece.size() > kMostRequestBytes - text.size()) throw Refused(too_large(false, kMostRequestBytes));
    text += piece;
    return true;
  };
  if (!body(take)) throw Refused({400, "the request ended before its body did", ""});
  return text;
}

Answer take_model(Studio& studio, const std::string& name, const BodyReader& body) {
  std::unique_ptr<Upload> upload = studio.begin_upload(name);
  const auto take = [&](std::string_view piece) {
    upload->write(piece);
    return true;
  };
  if (!body(take))
    throw Refused({400, fmt::format("{:.120}: it ended before it was whole", name), "send it again"});
  return of(json_of(studio.take(std::move(upload))));
}

Answer read(Studio& studio, std::span<const std::string> words) {
  const std::size_t count = words.size();
  const auto is = [&](std::size_t at, std::string_view word) { return words[at] == word; };
  if (count == 1 && is(0, "state")) return of(state_of(studio));
  if (count == 1 && is(0, "events")) return {.type = "text/event-stream", .is_event_stream = true};
  if (count == 3 && is(0, "models") && is(2, "scene")) return of(studio.scene_of_model(words[1]), kBinary);
  if (count >= 3 && is(0, "jobs")) {
    if (count == 3 && is(2, "scene")) return of(studio.scene_of_job(words[1]), kBinary);
    if (count == 3 && is(2, "report")) return of(studio.report_of_job(words[1]), "application/json");
    if (count == 3 && is(2, "report.txt"))
      return of(studio.report_text_of_job(words[1]), "text/plain; charset=utf-8");
    if (count == 4 && is(2, "file")) {
      Answer file = of(studio.result_of_job(words[1], words[3]), kBinary);
      file.is_to_save = true;
      return file;
    }
  }
  throw Refused({404, "there is nothing of this name", ""});
}

Answer change(Studio& studio, const ApiRequest& request, std::span<const std::string> words,
              const BodyReader& body) {
  const std::size_t count = words.size();
  const auto is = [&](std::size_t at, std::string_view word) { return words[at] == word; };
  if (count == 1 && is(0, "models")) return take_model(studio, request.name, body);
  if (count == 1 && is(0, "jobs")) {
    const JobRequest job = parse_job_request(whole(body));
    return of(json_of(studio.start_job(job.model, job.options, job.options_as_sent)));
  }
  if (count == 1 && is(0, "estimate")) {
    const JobRequest job = parse_job_request(whole(body));
    return of(json_of(studio.outlook(job.model, job.options)));
  }
  if (count == 3 && is(0, "jobs") && is(2, "stop")) return of(json_of(studio.stop_job(words[1])));
  if (count == 3 && is(2, "remove")) {
    if (is(0, "jobs")) {
      studio.remove_job(words[1]);
      return of(Json::object());
    }
    if (is(0, "models")) {
      studio.remove_model(words[1]);
      return of(Json::object());
    }
  }
  throw Refused({404, "there is nothing of this name", ""});
}

Answer asset(std::string_view path) {
  const std::string_view name = path == "/" ? std::string_view("studio.html") : path.substr(1);
  const auto bytes = built_file(name);
  if (!bytes) throw Refused({404, why_no_built_file(name), ""});
  const char* const type = name.ends_with(".js")    ? "text/javascript; charset=utf-8"
                           : name.ends_with(".css") ? "text/css; charset=utf-8"
                                                    : "text/html; charset=utf-8";
  return {.type = type, .body = std::string(*bytes)};
}

}  // namespace

Answer answer_to(const Refusal& refusal) {
  Answer answer{.status = refusal.status, .body = text_of({{"error", json_of(refusal)}})};
  return answer;
}

Answer answer(Studio& studio, const ApiRequest& request, const BodyReader& body) {
  try {
    if (is_asset(request.path)) return asset(request.path);
    if (!request.path.starts_with("/api/")) throw Refused({404, "there is nothing of this name", ""});
    const std::vector<std::string> words = words_of(request.path);
    return request.method == "POST" ? change(studio, request, words, body) : read(studio, words);
  } catch (...) {
    return answer_to(refusal_of(std::current_exception()));
  }
}

std::string events_of(const Changes& changes) {
  std::string text;
  const auto add = [&](const char* event, const Json& data) {
    text += fmt::format("event: {}\ndata: {}\n\n", event, text_of(data));
  };
  for (const ModelRecord& model : changes.models) add("model", json_of(model));
  for (const JobRecord& job : changes.jobs) add("job", json_of(job));
  for (const std::string& id : changes.removed) add("removed", {{"id", id}});
  return text;
}

}  // namespace aerate::studio
