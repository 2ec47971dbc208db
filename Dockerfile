# The program on its own, with all scenarios built in:
#   docker build -t squall . && docker run --rm -it -p 8088:8088 squall demo --listen 0.0.0.0:8088 --token secret
# Then open http://localhost:8088/#token=secret. To train and evaluate without network and page, built in half the time:
#   docker build -t squall-train --build-arg FEATURES=--no-default-features .
#   docker run --rm -v "$PWD:/work" squall-train train first
FROM rust:1.95-bookworm AS build
ARG FEATURES=
WORKDIR /squall
COPY . .
RUN cargo build --locked --release $FEATURES && strip target/release/squall

FROM debian:bookworm-slim
COPY --from=build /squall/target/release/squall /usr/local/bin/squall
# Mount a folder here for recordings and your own files.
WORKDIR /work
ENTRYPOINT ["squall"]
