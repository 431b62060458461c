//! The requests of the page, each as one function.

use std::sync::Arc;

use axum::Json;
use axum::body::Bytes;
use axum::extract::rejection::{BytesRejection, JsonRejection};
use axum::extract::{Path, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{Html, IntoResponse, Response};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};

use super::draft::Draft;
use super::guard::too_long;
use super::library::{Over, Unsaved};
use super::office::Office;
use super::refusal::Refusal;
use super::rewind::{self, Uncompared};
use tactpad_bridge::request::Request;
use tactpad_core::pad::device::Device;
use tactpad_core::pipeline::mapping::read::ReadProfile;
use tactpad_core::pipeline::mapping::read::shipped;
use tactpad_lab::play::sheet::Sheet;

type Shared = State<Arc<Office>>;

/// The answer of most requests.
pub(super) type Answer = Result<Response, Refusal>;

/// Works on a thread that may wait.
pub(super) async fn wait<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> Result<T, Refusal> {
    tokio::task::spawn_blocking(work).await.map_err(|_| Refusal::unavailable("this failed: try it again"))
}

/// Asks the bridge, and hands on its answer.
pub(super) async fn ask(office: Arc<Office>, request: Request) -> Answer {
    let answer = wait(move || office.ask(request)).await??;
    Ok(told(answer))
}

/// An answer of the bridge; one that refuses is no success.
fn told(answer: Value) -> Response {
    let is_refused = answer.get("ok").is_some_and(|ok| ok == false);
    let status = if is_refused { StatusCode::CONFLICT } else { StatusCode::OK };
    (status, Json(answer)).into_response()
}

/// The JSON of a request, or what is wrong with it.
pub(super) fn body<T: DeserializeOwned>(body: Result<Json<T>, JsonRejection>) -> Result<T, Refusal> {
    body.map(|Json(asked)| asked).map_err(|rejection| match rejection.status() {
        StatusCode::PAYLOAD_TOO_LARGE => too_long(),
        status => Refusal::new(status, rejection.body_text()),
    })
}

pub(super) async fn status(State(office): Shared) -> Answer {
    ask(office, Request::Status).await
}

/// `POST /api/pause`, `resume`, `panic`, `tare`.
pub(super) async fn act(State(office): Shared, Path(action): Path<String>) -> Answer {
    let request = match action.as_str() {
        "pause" => Request::Pause,
        "resume" => Request::Resume,
        "panic" => Request::ReleaseAll,
        "tare" => Request::Retare,
        _ => return Err(Refusal::new(StatusCode::NOT_FOUND, "there is no such request")),
    };
    ask(office, request).await
}

#[derive(Deserialize)]
pub(super) struct Named {
    name: String,
}

/// `POST /api/play`: goes over to another profile.
pub(super) async fn play(State(office): Shared, asked: Result<Json<Named>, JsonRejection>) -> Answer {
    let Named { name } = body(asked)?;
    wait(move || {
        // Only names: what is a file is not the page's to read.
        if office.library.read(&name).is_none() {
            return Err(unknown(&name));
        }
        office.forget_preview();
        office.ask(Request::Profile(Some(name))).map(told)
    })
    .await?
}

fn unknown(name: &str) -> Refusal {
    Refusal::new(StatusCode::NOT_FOUND, format!("there is no profile {name:?}: choose one of the list"))
}

pub(super) async fn profiles(State(office): Shared) -> Answer {
    let (profiles, playing) = wait(move || (office.library.entries(), office.library.playing())).await?;
    Ok(Json(json!({"profiles": profiles, "playing": playing})).into_response())
}

pub(super) async fn profile(State(office): Shared, Path(name): Path<String>) -> Answer {
    let (stored, name) = wait(move || (office.library.read(&name), name)).await?;
    stored.map(|stored| Json(stored).into_response()).ok_or_else(|| unknown(&name))
}

/// `PUT /api/profile/NAME`: keeps the text of the body. `If-Match: VERSION` and `If-None-Match: *` say what it may be written over.
pub(super) async fn save(
    State(office): Shared,
    Path(name): Path<String>,
    headers: HeaderMap,
    text: Result<Bytes, BytesRejection>,
) -> Answer {
    let text = text.map_err(|rejection| match rejection.status() {
        StatusCode::PAYLOAD_TOO_LARGE => too_long(),
        status => Refusal::new(status, rejection.body_text()),
    })?;
    let text = String::from_utf8(text.to_vec())
        .map_err(|_| Refusal::new(StatusCode::UNPROCESSABLE_ENTITY, "a profile is text in UTF-8"))?;
    let over = over(&headers);
    wait(move || {
        let saved = match office.library.save(&name, &text, &over) {
            Ok(saved) => saved,
            Err(why) => return unsaved(why),
        };
        if office.library.playing() == name {
            office.forget_preview();
            office.ask(Request::Profile(None))?;
        }
        Ok(Json(json!({"ok": true, "version": saved.version, "path": saved.path})).into_response())
    })
    .await?
}

fn over(headers: &HeaderMap) -> Over {
    let text = |name| headers.get(name).and_then(|value| value.to_str().ok());
    match (text(header::IF_MATCH), text(header::IF_NONE_MATCH)) {
        (Some(version), _) if version != "*" => Over::Version(version.trim_matches('"').to_owned()),
        (None, Some("*")) => Over::Nothing,
        _ => Over::Anything,
    }
}

/// Why a profile was not kept, as an answer.
fn unsaved(unsaved: Unsaved) -> Result<Response, Refusal> {
    match unsaved {
        Unsaved::Name(error) => Err(Refusal::new(StatusCode::BAD_REQUEST, error)),
        Unsaved::Changed(error) => Err(Refusal::new(StatusCode::PRECONDITION_FAILED, error)),
        Unsaved::Failed(error) => Err(Refusal::new(StatusCode::INTERNAL_SERVER_ERROR, error)),
        Unsaved::Errors(diagnostics) => {
            let answer = json!({"ok": false, "error": "the profile has errors", "diagnostics": diagnostics});
            Ok((StatusCode::UNPROCESSABLE_ENTITY, Json(answer)).into_response())
        }
    }
}

pub(super) async fn schema() -> Response {
    ([(header::CONTENT_TYPE, "application/json")], shipped::schema()).into_response()
}

/// `POST /api/draft`: changes a text and says what there is to say of it.
pub(super) async fn draft(State(office): Shared, asked: Result<Json<Draft>, JsonRejection>) -> Answer {
    let draft = body(asked)?;
    Ok(Json(wait(move || draft.answer(office.library.output())).await?).into_response())
}

#[derive(Deserialize)]
pub(super) struct Text {
    text: String,
}

/// `POST /api/preview`: plays a text that is not kept.
pub(super) async fn preview(State(office): Shared, asked: Result<Json<Text>, JsonRejection>) -> Answer {
    let Text { text } = body(asked)?;
    wait(move || {
        let (read, diagnostics) = ReadProfile::read(&text, office.library.output());
        let Some(read) = read else {
            let answer = json!({"ok": false, "error": "the profile has errors", "diagnostics": diagnostics});
            return Ok((StatusCode::UNPROCESSABLE_ENTITY, Json(answer)).into_response());
        };
        let mut answer = office.preview(read)?;
        if let Some(answer) = answer.as_object_mut() {
            answer.insert("diagnostics".into(), json!(diagnostics));
        }
        Ok(told(answer))
    })
    .await?
}

/// `DELETE /api/preview`: plays what is kept.
pub(super) async fn end_preview(State(office): Shared) -> Answer {
    Ok(told(wait(move || office.end_preview()).await??))
}

/// `POST /api/rewind`: what a text would have done in the last minute.
pub(super) async fn rewind(
    State(office): Shared,
    asked: Result<Json<rewind::Asked>, JsonRejection>,
) -> Answer {
    let asked = body(asked)?;
    let answer = wait(move || asked.answer(office.past(), office.library.output())).await?;
    answer.map(|answer| Json(answer).into_response()).map_err(|why| match why {
        Uncompared::Errors => Refusal::new(StatusCode::UNPROCESSABLE_ENTITY, "the profile has errors"),
        Uncompared::NoPlay => {
            Refusal::new(StatusCode::CONFLICT, "nothing was played yet: press the pad, then ask again")
        }
    })
}

pub(super) async fn doctor(State(office): Shared) -> Answer {
    Ok(Json(wait(move || office.library.doctor()).await?).into_response())
}

pub(super) async fn reports(State(office): Shared) -> Answer {
    let reports = wait(move || office.library.reports()).await?;
    Ok(Json(json!({"reports": reports})).into_response())
}

/// `GET /report/ID`: the page of a diagnosis.
pub(super) async fn report(State(office): Shared, Path(id): Path<String>) -> Answer {
    let page =
        wait(move || office.library.report(&id).and_then(|path| std::fs::read_to_string(path).ok())).await?;
    page.map(|page| Html(page).into_response()).ok_or_else(|| {
        Refusal::new(
            StatusCode::NOT_FOUND,
            "this report is no longer there: make it again with `tactpad diagnose`",
        )
    })
}

/// `GET /api/guides`: how all guides stand.
pub(super) async fn guides(State(office): Shared) -> Answer {
    let told = office.with_guides(|guides, scene| {
        guides.look(scene);
        guides.told()
    });
    Ok(Json(json!({"guides": told})).into_response())
}

/// `GET /sheet/NAME`: the marks that a known weight is put on, in true size.
pub(super) async fn sheet(Path(name): Path<String>) -> Answer {
    let sheet = || Sheet::of(&Device::nominal());
    let (kind, bytes) = match name.as_str() {
        "marks.pdf" => ("application/pdf", sheet().pdf()),
        "marks.svg" => ("image/svg+xml", sheet().svg().into_bytes()),
        _ => return Err(Refusal::new(StatusCode::NOT_FOUND, "there are the sheets marks.pdf and marks.svg")),
    };
    let kept = format!("attachment; filename=\"{name}\"");
    let head = [(header::CONTENT_TYPE, kind.to_owned()), (header::CONTENT_DISPOSITION, kept)];
    Ok((head, bytes).into_response())
}

#[derive(Deserialize)]
pub(super) struct Action {
    #[serde(rename = "do")]
    action: String,
    /// The number that the action takes.
    number: Option<f64>,
}

/// `POST /api/guides/ID`: begins a guide, stops it, or does what a step offers.
pub(super) async fn guide(
    State(office): Shared,
    Path(id): Path<String>,
    asked: Result<Json<Action>, JsonRejection>,
) -> Answer {
    let Action { action, number } = body(asked)?;
    wait(move || {
        let done = office.with_guides(|guides, scene| guides.act(&id, (&action, number), scene));
        let done =
            done.ok_or_else(|| Refusal::new(StatusCode::NOT_FOUND, format!("there is no guide {id:?}")))?;
        let done = done.map_err(|error| Refusal::new(StatusCode::CONFLICT, error))?;
        if let Some(request) = done.request {
            office.ask(request)?;
        }
        Ok(Json(done.told).into_response())
    })
    .await?
}
