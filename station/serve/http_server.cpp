#include "station/serve/http_server.h"

#include <algorithm>
#include <atomic>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/thread_pool.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <deque>
#include <list>
#include <stdexcept>

#include "station/documents/disk/stored_file.h"
#include "station/documents/text_pieces.h"

namespace station {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using boost::system::error_code;
using Clock = std::chrono::steady_clock;

constexpr auto kWriteTime = std::chrono::seconds(30);
constexpr auto kHeartbeat = std::chrono::seconds(15);

std::optional<std::string> decoded(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      out += text[i] == '+' ? ' ' : text[i];
      continue;
    }
    const auto digit = [&](std::size_t k) {
      const char c = k < text.size() ? text[k] : 'x';
      return c >= '0' && c <= '9'   ? c - '0'
             : c >= 'a' && c <= 'f' ? c - 'a' + 10
             : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                    : -1;
    };
    const int high = digit(i + 1), low = digit(i + 2);
    if (high < 0 || low < 0 || 16 * high + low == 0) return std::nullopt;
    out += static_cast<char>(16 * high + low);
    i += 2;
  }
  return out;
}

// None for a target that is none of ours to read.
std::optional<HttpRequest> plain(const http::request<http::string_body>& message) {
  HttpRequest request{.method = std::string(message.method_string()), .body = message.body()};
  const std::string_view target{message.target().data(), message.target().size()};
  const std::size_t question = std::min(target.find('?'), target.size());
  const auto path = decoded(target.substr(0, question));
  if (!path || !path->starts_with('/')) return std::nullopt;
  request.path = *path;
  for (std::string_view rest = target.substr(std::min(question + 1, target.size())); !rest.empty();) {
    const std::size_t end = std::min(rest.find('&'), rest.size()), equals = std::min(rest.find('='), end);
    const auto name = decoded(rest.substr(0, equals));
    const auto value = decoded(equals < end ? rest.substr(equals + 1, end - equals - 1) : std::string_view());
    if (!name || !value) return std::nullopt;
    request.query[*name] = *value;
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  for (const auto& field : message) {
    // The values of a header that comes twice are joined. The guard knows no such value, so the request is refused.
    std::string& value = request.headers[lower_case(std::string(field.name_string()))];
    value += (value.empty() ? "" : ", ") + std::string(field.value());
  }
  return request;
}

HttpResponse text(int status, const std::string& line) {
  return {.status = status, .body = line + "\n"};
}

}  // namespace

struct HttpServer::Impl {
  class Connection;

  Impl(const std::string& address, std::uint16_t port, Urgent urgent_, Handle handle_, const HttpLimits& limits_)
      : limits(limits_), urgent(std::move(urgent_)), handle(std::move(handle_)), acceptor(io), heartbeat(io) {
    error_code error;
    const auto ip = asio::ip::make_address(address, error);
    const asio::ip::tcp::endpoint endpoint(ip, port);
    if (!error) acceptor.open(endpoint.protocol(), error);
    if (!error) acceptor.set_option(asio::socket_base::reuse_address(true), error);
    if (!error) acceptor.bind(endpoint, error);
    if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
    if (error)
      throw std::runtime_error("cannot listen on " + address + " port " + std::to_string(port) + ": " +
                               error.message() + "; choose another with --port");
  }

  void accept();
  void beat();
  void make_room();
  bool too_many_requests();
  void drop(const std::shared_ptr<Connection>& connection);
  void tell(const std::string& event);

  HttpLimits limits;
  Urgent urgent;
  Handle handle;
  asio::io_context io{1};
  asio::thread_pool workers{2};
  asio::ip::tcp::acceptor acceptor;
  asio::steady_timer heartbeat;
  std::list<std::shared_ptr<Connection>> connections;  // the one that has waited longest first
  std::atomic<std::size_t> waiting{0};
  double budget = 0;
  Clock::time_point budget_at = limits.now();
};

// One socket: request, answer, request ... or one stream of events.
class HttpServer::Impl::Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(asio::ip::tcp::socket socket, Impl& server) : stream_(std::move(socket)), server_(server) {}

  bool idle() const { return state_ == State::reading; }
  bool streaming() const { return state_ == State::streaming; }

  void read() {
    state_ = State::reading;
    parser_.emplace();
    parser_->header_limit(server_.limits.header_bytes);
    parser_->body_limit(server_.limits.body_bytes);
    stream_.expires_after(server_.limits.request_time);
    http::async_read(stream_, buffer_, *parser_,
                     [self = shared_from_this()](const error_code& error, std::size_t) { self->was_read(error); });
  }

  void close() {
    error_code ignored;
    stream_.socket().close(ignored);
  }

  void send_event(const std::string& event) {
    if (!streaming()) return;
    queued_bytes_ += event.size();
    if (queued_bytes_ > server_.limits.stream_bytes) return server_.drop(shared_from_this());
    events_.push_back(event);
    if (events_.size() == 1) write_event();
  }

 private:
  enum class State { reading, answering, streaming };

  void was_read(const error_code& error) {
    if (error == http::error::body_limit) return answer(text(413, "the request is larger than this server reads"));
    if (error == http::error::header_limit) return answer(text(431, "the request's header is too long"));
    if (error == http::error::end_of_stream || error == beast::error::timeout || error == asio::error::eof ||
        error == asio::error::operation_aborted || error == asio::error::connection_reset)
      return server_.drop(shared_from_this());
    if (error) return answer(text(400, "this is no HTTP request"));
    state_ = State::answering;
    stream_.expires_never();
    const http::request<http::string_body> message = parser_->release();
    keep_alive_ = message.keep_alive();
    version_ = message.version();
    head_ = message.method() == http::verb::head;
    std::optional<HttpRequest> request = plain(message);
    if (!request) return answer(text(400, "the address cannot be read"));
    if (std::optional<HttpResponse> now = server_.urgent(*request)) return answer(*std::move(now));
    if (server_.too_many_requests()) return answer(text(429, "too many requests; wait a second"));
    if (server_.waiting >= server_.limits.waiting_requests) return answer(text(503, "busy; try again"));
    ++server_.waiting;
    asio::post(server_.workers, [self = shared_from_this(), request = *std::move(request)] {
      HttpResponse response;
      try {
        response = self->server_.handle(request);
      } catch (const std::exception& problem) {
        response = text(500, problem_line(problem));
      }
      --self->server_.waiting;
      asio::post(self->server_.io,
                 [self, response = std::move(response)]() mutable { self->answer(std::move(response)); });
    });
  }

  void answer(HttpResponse response) {
    if (response.stream && std::ranges::count_if(server_.connections, [](const auto& c) { return c->streaming(); }) >=
                               static_cast<std::ptrdiff_t>(server_.limits.streams))
      response = text(503, "too many pages watch already; close one");
    if (!parser_ || response.status == 400 || response.status == 413 || response.status == 431) keep_alive_ = false;
    state_ = State::answering;
    auto message = std::make_shared<http::response<http::string_body>>();
    message->version(version_);
    message->result(static_cast<unsigned>(response.status));
    message->set(http::field::content_type, response.stream ? "text/event-stream" : response.content_type);
    message->set(http::field::cache_control, "no-store");
    message->set("X-Content-Type-Options", "nosniff");
    for (const auto& [name, value] : response.headers) message->set(name, value);
    stream_.expires_after(kWriteTime);
    if (response.stream) {
      message->keep_alive(false);
      auto serializer = std::make_shared<http::response_serializer<http::string_body>>(*message);
      http::async_write_header(stream_, *serializer,
                               [self = shared_from_this(), message, serializer](const error_code& error, std::size_t) {
                                 if (error) return self->server_.drop(self);
                                 self->stream_.expires_never();
                                 self->state_ = State::streaming;
                                 self->watch_for_end();
                                 self->send_event(": here\n\n");
                               });
      return;
    }
    message->keep_alive(keep_alive_);
    const std::size_t size = response.body.size();
    if (!head_) message->body() = std::move(response.body);
    message->prepare_payload();
    if (head_) message->content_length(size);
    http::async_write(stream_, *message, [self = shared_from_this(), message](const error_code& error, std::size_t) {
      if (error || !message->keep_alive()) return self->finish();
      self->server_.connections.remove(self);  // to the end: it has just begun to wait
      self->server_.connections.push_back(self);
      self->read();
    });
  }

  // Lets the client read the answer before the socket goes.
  void finish() {
    error_code ignored;
    stream_.socket().shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
    server_.drop(shared_from_this());
  }

  // A client of a stream sends nothing more: when it does, or goes, the stream ends.
  void watch_for_end() {
    stream_.socket().async_wait(asio::ip::tcp::socket::wait_read,
                                [self = shared_from_this()](const error_code&) { self->server_.drop(self); });
  }

  void write_event() {
    stream_.expires_after(kWriteTime);
    asio::async_write(stream_, asio::buffer(events_.front()),
                      [self = shared_from_this()](const error_code& error, std::size_t) {
                        if (error) return self->server_.drop(self);
                        self->queued_bytes_ -= self->events_.front().size();
                        self->events_.pop_front();
                        if (self->events_.empty())
                          self->stream_.expires_never();
                        else
                          self->write_event();
                      });
  }

  beast::tcp_stream stream_;
  Impl& server_;
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::string_body>> parser_;
  State state_ = State::reading;
  bool keep_alive_ = true, head_ = false;
  unsigned version_ = 11;
  std::deque<std::string> events_;
  std::size_t queued_bytes_ = 0;
};

void HttpServer::Impl::accept() {
  acceptor.async_accept([this](const error_code& error, asio::ip::tcp::socket socket) {
    if (error == asio::error::operation_aborted) return;
    if (!error) {
      make_room();
      connections.push_back(std::make_shared<Connection>(std::move(socket), *this));
      connections.back()->read();
      return accept();
    }
    // Out of descriptors: somebody has to go, and a moment to pass.
    make_room();
    heartbeat.expires_after(std::chrono::milliseconds(100));
    heartbeat.async_wait([this](const error_code& stopped) {
      if (stopped) return;
      accept();
      beat();
    });
  });
}

void HttpServer::Impl::beat() {
  heartbeat.expires_after(kHeartbeat);
  heartbeat.async_wait([this](const error_code& stopped) {
    if (stopped) return;
    tell(": still here\n\n");
    beat();
  });
}

void HttpServer::Impl::make_room() {
  while (connections.size() >= limits.connections) {
    const auto idle = std::ranges::find_if(connections, [](const auto& c) { return c->idle(); });
    drop(idle == connections.end() ? connections.front() : *idle);
  }
}

void HttpServer::Impl::drop(const std::shared_ptr<Connection>& connection) {
  const std::shared_ptr<Connection> kept = connection;
  kept->close();
  connections.remove(kept);
}

bool HttpServer::Impl::too_many_requests() {
  const Clock::time_point now = limits.now();
  budget = std::min(limits.requests_per_s,
                    budget + limits.requests_per_s * std::chrono::duration<double>(now - budget_at).count());
  budget_at = now;
  if (budget < 1) return true;
  budget -= 1;
  return false;
}

void HttpServer::Impl::tell(const std::string& event) {
  const auto all = connections;  // sending may drop
  for (const auto& connection : all) connection->send_event(event);
}

HttpServer::HttpServer(const std::string& address, std::uint16_t port, Urgent urgent, Handle handle,
                       const HttpLimits& limits)
    : impl_(std::make_unique<Impl>(address, port, std::move(urgent), std::move(handle), limits)) {
  impl_->budget = limits.requests_per_s;
}

HttpServer::~HttpServer() {
  stop();
  impl_->workers.join();
}

std::uint16_t HttpServer::port() const {
  return impl_->acceptor.local_endpoint().port();
}

void HttpServer::run() {
  impl_->accept();
  impl_->beat();
  impl_->io.run();
  impl_->workers.join();
}

void HttpServer::stop() {
  impl_->io.stop();
}

void HttpServer::publish(const std::string& data) {
  asio::post(impl_->io, [this, event = "data: " + data + "\n\n"] { impl_->tell(event); });
}

}  // namespace station
