# The program alone, with all scenarios inside of it:
#   docker build -t squall . && docker run --rm -it -p 8088:8088 squall demo --listen 0.0.0.0:8088 --token secret
FROM rust:1.95-bookworm AS build
WORKDIR /squall
COPY . .
RUN cargo build --locked --release && strip target/release/squall

FROM debian:bookworm-slim
COPY --from=build /squall/target/release/squall /usr/local/bin/squall
# Recordings and files of one's own: mount a folder here.
WORKDIR /work
ENTRYPOINT ["squall"]
