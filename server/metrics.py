"""Counters for Prometheus; one registry a server, so that two in one process do not mix."""

from __future__ import annotations

from prometheus_client import CollectorRegistry, Counter, Gauge, Histogram, generate_latest

MILLISECONDS = (0.005, 0.01, 0.02, 0.033, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 30.0)


class Metrics:
    """What the server counts."""

    def __init__(self) -> None:
        self.registry = CollectorRegistry()
        self.sessions = Gauge("umbrage_sessions", "Live views connected", registry=self.registry)
        self.frames = Counter("umbrage_frames", "Frames sent to live views", registry=self.registry)
        self.frame_bytes = Counter("umbrage_frame_bytes", "Bytes of images sent to live views", registry=self.registry)
        self.render = Histogram(
            "umbrage_frame_seconds",
            "Time of a live frame, from the request to its pixels",
            buckets=MILLISECONDS,
            registry=self.registry,
        )
        self.refused = Counter("umbrage_refused_messages", "WebSocket messages refused", registry=self.registry)
        self.pictures = Counter("umbrage_pictures", "Pictures rendered over HTTP", registry=self.registry)
        self.uploads = Counter("umbrage_uploads", "Uploads by outcome", ["outcome"], registry=self.registry)
        self.jobs = Counter(
            "umbrage_jobs", "Finished jobs by kind and outcome", ["kind", "outcome"], registry=self.registry
        )

    def text(self) -> bytes:
        """The exposition format."""
        return generate_latest(self.registry)
