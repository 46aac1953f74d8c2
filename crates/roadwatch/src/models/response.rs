//! What a server's answer means for a part of a file.

use ureq::http::{HeaderMap, Response, StatusCode, header};

/// What to do with an answer to a request for a file, or for the rest of it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Meaning {
    /// The body goes behind what is there; the whole has `total` bytes.
    Rest {
        /// Bytes of the whole; `None` when the server does not know.
        total: Option<u64>,
    },
    /// The body is the file from its first byte: what is there is of no use.
    Whole {
        /// Bytes of the whole; `None` when the server does not say.
        total: Option<u64>,
    },
    /// Nothing comes behind what is there: it is whole, or of no use.
    NothingBehind {
        /// Bytes of the whole; `None` when the server does not say.
        total: Option<u64>,
    },
    /// The server is in trouble, which may pass.
    Busy(StatusCode),
    /// The server refuses, and will again.
    Refused(StatusCode),
}

impl Meaning {
    /// Of the answer to a request for everything from byte `offset` on.
    pub(super) fn of<B>(response: &Response<B>, offset: u64) -> Self {
        let headers = response.headers();
        match response.status() {
            StatusCode::OK => Self::Whole {
                total: number(headers, header::CONTENT_LENGTH),
            },
            StatusCode::PARTIAL_CONTENT if offset > 0 => match ContentRange::of(headers) {
                Some(range) if range.first == Some(offset) => Self::Rest { total: range.total },
                // Another range than the one that was asked for.
                _ => Self::NothingBehind { total: None },
            },
            StatusCode::RANGE_NOT_SATISFIABLE if offset > 0 => Self::NothingBehind {
                total: ContentRange::of(headers).and_then(|range| range.total),
            },
            status if may_pass(status) => Self::Busy(status),
            status => Self::Refused(status),
        }
    }
}

/// The server's word for this version of the file that `If-Range` takes: a strong ETag, or else a date.
pub(super) fn version<B>(response: &Response<B>) -> Option<String> {
    let text = |name| response.headers().get(name)?.to_str().ok();
    let strong = text(header::ETAG).filter(|etag| !etag.starts_with("W/"));
    strong
        .or_else(|| text(header::LAST_MODIFIED))
        .map(str::to_owned)
}

fn may_pass(status: StatusCode) -> bool {
    status.is_server_error()
        || status == StatusCode::REQUEST_TIMEOUT
        || status == StatusCode::TOO_MANY_REQUESTS
}

fn number(headers: &HeaderMap, name: header::HeaderName) -> Option<u64> {
    headers.get(name)?.to_str().ok()?.trim().parse().ok()
}

/// `bytes 5-9/10` or `bytes */10`.
struct ContentRange {
    first: Option<u64>,
    total: Option<u64>,
}

impl ContentRange {
    fn of(headers: &HeaderMap) -> Option<Self> {
        let text = headers.get(header::CONTENT_RANGE)?.to_str().ok()?;
        let (range, total) = text.strip_prefix("bytes ")?.split_once('/')?;
        let first = range.split_once('-').map(|(first, _)| first);
        Some(Self {
            first: first.and_then(|first| first.trim().parse().ok()),
            total: total.trim().parse().ok(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn meaning(status: u16, headers: &[(&str, &str)], offset: u64) -> Meaning {
        let mut response = Response::builder().status(status);
        for (name, value) in headers {
            response = response.header(*name, *value);
        }
        Meaning::of(&response.body(()).expect("an answer"), offset)
    }

    #[test]
    fn only_the_rest_that_was_asked_for_is_appended() {
        let range = [("content-range", "bytes 5-9/10")];
        assert_eq!(meaning(206, &range, 5), Meaning::Rest { total: Some(10) });
        let other = Meaning::NothingBehind { total: None };
        assert_eq!(meaning(206, &range, 4), other);
        assert_eq!(meaning(206, &[], 5), other);
    }

    #[test]
    fn an_answer_with_everything_begins_anew() {
        let length = [("content-length", "10")];
        assert_eq!(meaning(200, &length, 5), Meaning::Whole { total: Some(10) });
        assert_eq!(meaning(200, &[], 0), Meaning::Whole { total: None });
    }

    #[test]
    fn nothing_behind_the_end_tells_how_long_the_whole_is() {
        let range = [("content-range", "bytes */10")];
        let whole = Meaning::NothingBehind { total: Some(10) };
        assert_eq!(meaning(416, &range, 10), whole);
        let refused = Meaning::Refused(StatusCode::RANGE_NOT_SATISFIABLE);
        assert_eq!(meaning(416, &range, 0), refused);
    }

    #[test]
    fn trouble_may_pass_and_refusals_stay() {
        for status in [429, 500, 503, 408] {
            assert!(matches!(meaning(status, &[], 0), Meaning::Busy(_)));
        }
        for status in [401, 403, 404, 204] {
            assert!(matches!(meaning(status, &[], 0), Meaning::Refused(_)));
        }
    }

    #[test]
    fn a_weak_etag_is_no_version() {
        let weak = Response::builder().header("etag", "W/\"a\"").body(());
        assert_eq!(version(&weak.expect("an answer")), None);
        let dated = Response::builder()
            .header("etag", "W/\"a\"")
            .header("last-modified", "Mon, 23 Nov 2026 00:00:00 GMT")
            .body(());
        let date = Some("Mon, 23 Nov 2026 00:00:00 GMT".to_owned());
        assert_eq!(version(&dated.expect("an answer")), date);
    }
}
