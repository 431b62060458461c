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

use super::app_state::AppState;
use super::draft::{self, Draft};
use super::guard::too_long;
use super::host::{Overwrite, SaveError};
use super::refusal::Refusal;
use super::rewind::{self, RewindError};
use tactpad_bridge::request::Request;
use tactpad_core::pad::device::Device;
use tactpad_core::pipeline::mapping::read::ReadProfile;
use tactpad_core::pipeline::mapping::read::shipped;
use tactpad_lab::play::sheet::Sheet;

type Shared = State<Arc<AppState>>;

/// The answer of most requests.
pub(super) type ApiResult = Result<Response, Refusal>;

/// Works on a thread that may wait.
pub(super) async fn wait<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> Result<T, Refusal> {
    tokio::task::spawn_blocking(work).await.map_err(|_| Refusal::unavailable("this failed: try it again"))
}

/// Asks the bridge, and hands on its answer.
pub(super) async fn ask(app: Arc<AppState>, request: Request) -> ApiResult {
    let answer = wait(move || app.ask(request)).await??;
    Ok(response(answer))
}

/// An answer of the bridge; one that refuses is no success.
fn response(answer: Value) -> Response {
    let is_refused = answer.get("ok").is_some_and(|ok| ok == false);
    let status = if is_refused { StatusCode::CONFLICT } else { StatusCode::OK };
    (status, Json(answer)).into_response()
}

/// The JSON of a request, or what is wrong with it.
pub(super) fn body<T: DeserializeOwned>(body: Result<Json<T>, JsonRejection>) -> Result<T, Refusal> {
    body.map(|Json(request)| request).map_err(|rejection| match rejection.status() {
        StatusCode::PAYLOAD_TOO_LARGE => too_long(),
        status => Refusal::new(status, rejection.body_text()),
    })
}

pub(super) async fn status(State(app): Shared) -> ApiResult {
    ask(app, Request::Status).await
}

/// `POST /api/pause`, `resume`, `panic`, `tare`.
pub(super) async fn act(State(app): Shared, Path(action): Path<String>) -> ApiResult {
    let request = match action.as_str() {
        "pause" => Request::Pause,
        "resume" => Request::Resume,
        "panic" => Request::ReleaseAll,
        "tare" => Request::Retare,
        _ => return Err(Refusal::new(StatusCode::NOT_FOUND, "there is no such request")),
    };
    ask(app, request).await
}

#[derive(Deserialize)]
pub(super) struct PlayRequest {
    name: String,
}

/// `POST /api/play`: goes over to another profile.
pub(super) async fn play(State(app): Shared, request: Result<Json<PlayRequest>, JsonRejection>) -> ApiResult {
    let PlayRequest { name } = body(request)?;
    wait(move || {
        // Only names: what is a file is not the page's to read.
        if app.host.read(&name).is_none() {
            return Err(unknown(&name));
        }
        app.forget_preview();
        app.ask(Request::Profile(Some(name))).map(response)
    })
    .await?
}

fn unknown(name: &str) -> Refusal {
    Refusal::new(StatusCode::NOT_FOUND, format!("there is no profile {name:?}: choose one of the list"))
}

pub(super) async fn profiles(State(app): Shared) -> ApiResult {
    let (profiles, playing) = wait(move || (app.host.entries(), app.host.playing())).await?;
    Ok(Json(json!({"profiles": profiles, "playing": playing})).into_response())
}

pub(super) async fn profile(State(app): Shared, Path(name): Path<String>) -> ApiResult {
    let (stored, name) = wait(move || (app.host.read(&name), name)).await?;
    stored.map(|stored| Json(stored).into_response()).ok_or_else(|| unknown(&name))
}

/// `PUT /api/profile/NAME`: keeps the text of the body. `If-Match: VERSION` and `If-None-Match: *` say what it may be written over.
pub(super) async fn save(
    State(app): Shared,
    Path(name): Path<String>,
    headers: HeaderMap,
    text: Result<Bytes, BytesRejection>,
) -> ApiResult {
    let text = text.map_err(|rejection| match rejection.status() {
        StatusCode::PAYLOAD_TOO_LARGE => too_long(),
        status => Refusal::new(status, rejection.body_text()),
    })?;
    let text = String::from_utf8(text.to_vec())
        .map_err(|_| Refusal::new(StatusCode::UNPROCESSABLE_ENTITY, "a profile is text in UTF-8"))?;
    let over = over(&headers);
    wait(move || {
        let saved = match app.host.save(&name, &text, &over) {
            Ok(saved) => saved,
            Err(why) => return unsaved(why),
        };
        if app.host.playing() == name {
            app.forget_preview();
            app.ask(Request::Profile(None))?;
        }
        Ok(Json(json!({"ok": true, "version": saved.version, "path": saved.path})).into_response())
    })
    .await?
}

fn over(headers: &HeaderMap) -> Overwrite {
    let text = |name| headers.get(name).and_then(|value| value.to_str().ok());
    match (text(header::IF_MATCH), text(header::IF_NONE_MATCH)) {
        (Some(version), _) if version != "*" => Overwrite::Version(version.trim_matches('"').to_owned()),
        (None, Some("*")) => Overwrite::Nothing,
        _ => Overwrite::Anything,
    }
}

/// Why a profile was not kept, as an answer.
fn unsaved(unsaved: SaveError) -> Result<Response, Refusal> {
    match unsaved {
        SaveError::Name(error) => Err(Refusal::new(StatusCode::BAD_REQUEST, error)),
        SaveError::Changed(error) => Err(Refusal::new(StatusCode::PRECONDITION_FAILED, error)),
        SaveError::Failed(error) => Err(Refusal::new(StatusCode::INTERNAL_SERVER_ERROR, error)),
        SaveError::Errors(diagnostics) => {
            let answer = json!({"ok": false, "error": "the profile has errors", "diagnostics": diagnostics});
            Ok((StatusCode::UNPROCESSABLE_ENTITY, Json(answer)).into_response())
        }
    }
}

/// `GET /api/profile/NAME/history`: the saves that are kept.
pub(super) async fn history(State(app): Shared, Path(name): Path<String>) -> ApiResult {
    let saves = wait(move || app.host.history(&name)).await?;
    Ok(Json(json!({"saves": saves})).into_response())
}

/// `GET /api/profile/NAME/history/ID`: the text of a save, or of the profile inside the program.
pub(super) async fn earlier(State(app): Shared, Path((name, id)): Path<(String, String)>) -> ApiResult {
    let text = wait(move || match id.as_str() {
        "shipped" => shipped::text(&name).map(str::to_owned),
        id => app.host.saved(&name, id.parse().ok()?),
    });
    let error = "this save is no longer kept: look at the list again";
    let text = text.await?.ok_or_else(|| Refusal::new(StatusCode::NOT_FOUND, error))?;
    Ok(Json(json!({"text": text})).into_response())
}

/// `DELETE /api/profile/NAME`: what plays must have something that plays in its place.
pub(super) async fn delete(State(app): Shared, Path(name): Path<String>) -> ApiResult {
    wait(move || {
        let is_playing = app.host.playing() == name;
        if is_playing && shipped::text(&name).is_none() {
            let error = format!("{name} is in play: play another profile first");
            return Err(Refusal::new(StatusCode::CONFLICT, error));
        }
        if let Err(why) = app.host.delete(&name) {
            return unsaved(why);
        }
        if is_playing {
            app.forget_preview();
            app.ask(Request::Profile(None))?;
        }
        Ok(Json(json!({"ok": true})).into_response())
    })
    .await?
}

#[derive(Deserialize)]
pub(super) struct RenameRequest {
    to: String,
}

/// `POST /api/profile/NAME/rename`: what plays goes on under its new name.
pub(super) async fn rename(
    State(app): Shared,
    Path(name): Path<String>,
    request: Result<Json<RenameRequest>, JsonRejection>,
) -> ApiResult {
    let RenameRequest { to } = body(request)?;
    wait(move || {
        let is_playing = app.host.playing() == name;
        if let Err(why) = app.host.rename(&name, &to) {
            return unsaved(why);
        }
        if is_playing {
            app.forget_preview();
            app.ask(Request::Profile(Some(to)))?;
        }
        Ok(Json(json!({"ok": true})).into_response())
    })
    .await?
}

/// `GET /api/decoders`: the user's own, which may go along with a profile.
pub(super) async fn decoders(State(app): Shared) -> ApiResult {
    let decoders = wait(move || app.host.decoders()).await?;
    Ok(Json(json!({"decoders": decoders})).into_response())
}

/// `GET /api/profile/NAME/export`: a profile as a file.
pub(super) async fn export(State(app): Shared, Path(name): Path<String>) -> ApiResult {
    exported(wait(move || app.host.exported(&name, None)).await?)
}

/// `GET /api/profile/NAME/export/DECODER`: a profile and a decoder as a file.
pub(super) async fn export_with_decoder(
    State(app): Shared,
    Path((name, decoder)): Path<(String, String)>,
) -> ApiResult {
    exported(wait(move || app.host.exported(&name, Some(&decoder))).await?)
}

fn exported(document: Option<String>) -> ApiResult {
    let error = "there is no such profile or decoder: choose from the lists";
    let document = document.ok_or_else(|| Refusal::new(StatusCode::NOT_FOUND, error))?;
    let head = [(header::CONTENT_TYPE, "application/json"), (header::CONTENT_DISPOSITION, "attachment")];
    Ok((head, document).into_response())
}

#[derive(Deserialize)]
pub(super) struct ImportRequest {
    document: String,
    name: String,
}

/// `POST /api/import`: makes the profile of an exported file the user's own.
pub(super) async fn import(
    State(app): Shared,
    request: Result<Json<ImportRequest>, JsonRejection>,
) -> ApiResult {
    let ImportRequest { document, name } = body(request)?;
    wait(move || match app.host.import(&document, &name) {
        Ok(decoder) => Ok(Json(json!({"ok": true, "decoder": decoder})).into_response()),
        Err(why) => unsaved(why),
    })
    .await?
}

pub(super) async fn schema() -> Response {
    ([(header::CONTENT_TYPE, "application/json")], shipped::schema()).into_response()
}

/// `POST /api/draft`: changes a text and says what there is to say of it.
pub(super) async fn draft(State(app): Shared, request: Result<Json<Draft>, JsonRejection>) -> ApiResult {
    let draft = body(request)?;
    Ok(Json(wait(move || draft.answer(app.host.output(), app.host.pad_has_shear())).await?).into_response())
}

#[derive(Deserialize)]
pub(super) struct PreviewRequest {
    text: String,
}

/// `POST /api/preview`: plays a text that is not kept.
pub(super) async fn preview(
    State(app): Shared,
    request: Result<Json<PreviewRequest>, JsonRejection>,
) -> ApiResult {
    let PreviewRequest { text } = body(request)?;
    wait(move || {
        let (read, diagnostics) = ReadProfile::read(&text, app.host.output());
        let diagnostics = draft::for_pad(diagnostics, &text, app.host.pad_has_shear());
        let Some(read) = read else {
            let answer = json!({"ok": false, "error": "the profile has errors", "diagnostics": diagnostics});
            return Ok((StatusCode::UNPROCESSABLE_ENTITY, Json(answer)).into_response());
        };
        let mut answer = app.preview(read)?;
        if let Some(answer) = answer.as_object_mut() {
            answer.insert("diagnostics".into(), json!(diagnostics));
        }
        Ok(response(answer))
    })
    .await?
}

/// `DELETE /api/preview`: plays what is kept.
pub(super) async fn end_preview(State(app): Shared) -> ApiResult {
    Ok(response(wait(move || app.end_preview()).await??))
}

/// `POST /api/rewind`: what a text would have done in the last minute.
pub(super) async fn rewind(
    State(app): Shared,
    request: Result<Json<rewind::RewindRequest>, JsonRejection>,
) -> ApiResult {
    let request = body(request)?;
    let answer = wait(move || request.answer(app.past(), app.host.output())).await?;
    answer.map(|answer| Json(answer).into_response()).map_err(|why| match why {
        RewindError::Errors => Refusal::new(StatusCode::UNPROCESSABLE_ENTITY, "the profile has errors"),
        RewindError::NoPlay => {
            Refusal::new(StatusCode::CONFLICT, "nothing was played yet: press the pad, then ask again")
        }
    })
}

pub(super) async fn doctor(State(app): Shared) -> ApiResult {
    Ok(Json(wait(move || app.host.doctor()).await?).into_response())
}

pub(super) async fn reports(State(app): Shared) -> ApiResult {
    let reports = wait(move || app.host.reports()).await?;
    Ok(Json(json!({"reports": reports})).into_response())
}

/// `GET /report/ID`: the page of a diagnosis.
pub(super) async fn report(State(app): Shared, Path(id): Path<String>) -> ApiResult {
    let page = wait(move || app.host.report(&id).and_then(|path| std::fs::read_to_string(path).ok())).await?;
    page.map(|page| Html(page).into_response()).ok_or_else(|| {
        Refusal::new(
            StatusCode::NOT_FOUND,
            "this report is no longer there: make it again with `tactpad diagnose`",
        )
    })
}

/// `GET /api/guides`: how all guides stand.
pub(super) async fn guides(State(app): Shared) -> ApiResult {
    let statuses = app.with_guides(|guides, context| {
        guides.update(context);
        guides.statuses()
    });
    Ok(Json(json!({"guides": statuses})).into_response())
}

#[derive(Deserialize)]
pub(super) struct ProfileSheetRequest {
    text: String,
    /// The date, as the reader writes dates.
    date: String,
}

/// `POST /api/sheet`: what a text does, as a drawing of one page.
pub(super) async fn profile_sheet(
    State(app): Shared,
    request: Result<Json<ProfileSheetRequest>, JsonRejection>,
) -> ApiResult {
    let ProfileSheetRequest { text, date } = body(request)?;
    let drawn = move || {
        ReadProfile::read(&text, app.host.output()).0.map(|read| Sheet::of_profile(read.profile(), &date))
    };
    let error = "the profile has errors: mend them first";
    let sheet = wait(drawn).await?.ok_or_else(|| Refusal::new(StatusCode::UNPROCESSABLE_ENTITY, error))?;
    Ok(Json(json!({"svg": sheet.svg()})).into_response())
}

/// `GET /sheet/NAME`: the marks that a known weight is put on, in true size.
pub(super) async fn sheet(Path(name): Path<String>) -> ApiResult {
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
pub(super) struct GuideRequest {
    #[serde(rename = "do")]
    action: String,
    /// The number that the action takes.
    number: Option<f64>,
}

/// `POST /api/guides/ID`: begins a guide, stops it, or does what a step offers.
pub(super) async fn guide(
    State(app): Shared,
    Path(id): Path<String>,
    request: Result<Json<GuideRequest>, JsonRejection>,
) -> ApiResult {
    let GuideRequest { action, number } = body(request)?;
    wait(move || {
        let done = app.with_guides(|guides, context| guides.act(&id, &action, number, context));
        let done =
            done.ok_or_else(|| Refusal::new(StatusCode::NOT_FOUND, format!("there is no guide {id:?}")))?;
        let done = done.map_err(|error| Refusal::new(StatusCode::CONFLICT, error))?;
        if let Some(request) = done.request {
            app.ask(request)?;
        }
        Ok(Json(done.status).into_response())
    })
    .await?
}
